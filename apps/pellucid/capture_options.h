// Options of the subcommands that capture fragments, and which of them have an effect.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "capture_job.h"

namespace pellucid::cli {

// Groups of options in --help.
constexpr const char* kImageGroup = "Image";
constexpr const char* kTechniqueGroup = "Technique";
constexpr const char* kBudgetGroup = "Memory budget";
constexpr const char* kCameraGroup = "Camera";
constexpr const char* kAnimationGroup = "Animation";
constexpr const char* kOutputGroup = "Output";
constexpr const char* kComparisonGroup = "Comparison";

// Adds what `render` and `compare` have in common of the groups Image, Technique and Memory budget; defaults
// are what `job` has.
void add_capture_options(CLI::App& command, CaptureJob& job);

// Throws Error{bad_argument} for the first option of add_capture_options() that was given and has no effect
// on any of `techniques`. `sweeps_memory`: some images are drawn with a pool and a memory budget of their
// own.
void refuse_capture_options_without_effect(const CLI::App& command, const CaptureJob& job,
                                           const std::vector<TechniqueInfo>& techniques,
                                           bool sweeps_memory = false);

// Returns what the reference on the CPU is among the techniques.
TechniqueInfo cpu_technique();
// Returns what the technique `name` is, also of "cpu". Throws Error{bad_argument} where there is none;
// `option` is the one that names it, `more` other values of that option.
TechniqueInfo technique_info(const std::string& name, const std::string& option, const std::string& more);

// Returns the names of --sync, after `automatic` the fastest first.
std::vector<std::pair<std::string, Sync>> sync_names();

struct Size {
  std::uint32_t width = 0, height = 0;
};
// Parses "1280x720". Throws Error{bad_argument}.
Size parse_size(const std::string& text);

}  // namespace pellucid::cli
