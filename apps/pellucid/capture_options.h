// Options of the subcommands that capture fragments, and checks that they have an effect. In: a command line.
// Out: a CaptureJob.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "capture_job.h"

namespace pellucid::cli {

// Names of the groups of options in --help.
constexpr const char* kImageGroup = "Image";
constexpr const char* kTechniqueGroup = "Technique";
constexpr const char* kBudgetGroup = "Memory budget";
constexpr const char* kCameraGroup = "Camera";
constexpr const char* kAnimationGroup = "Animation";
constexpr const char* kOutputGroup = "Output";
constexpr const char* kComparisonGroup = "Comparison";

// Adds the options of the groups Image, Technique and Memory budget that `render` and `compare` share. The
// defaults are the values in `job`.
void add_capture_options(CLI::App& command, CaptureJob& job);

// Throws Error{bad_argument} for the first option of add_capture_options() that was given and has no effect
// on any of `techniques`. `sweeps_memory` says that some images are drawn with a pool and a memory budget of
// their own.
void refuse_capture_options_without_effect(const CLI::App& command, const CaptureJob& job,
                                           const std::vector<TechniqueInfo>& techniques,
                                           bool sweeps_memory = false);

// Returns the description of the CPU reference as a technique.
TechniqueInfo cpu_technique();
// Returns the description of the technique `name`, which may be "cpu". Throws Error{bad_argument} if there is
// none. In the message, `option` is the option that names the technique, and `more` lists other values of
// that option.
TechniqueInfo technique_info(const std::string& name, const std::string& option, const std::string& more);

// Returns the names of --sync: first `automatic`, then the others, the fastest first.
std::vector<std::pair<std::string, Sync>> sync_names();

struct Size {
  std::uint32_t width = 0, height = 0;
};
// Parses "1280x720". Throws Error{bad_argument}.
Size parse_size(const std::string& text);

}  // namespace pellucid::cli
