// Options of the subcommands that capture fragments.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "capture_picture.h"

namespace pellucid::cli {

// --effect, --csg, --surfaces, --k, --sync, --pool, --overflow, --memory and what goes with it, --frames,
// --samples, --cull, --plain-resolve, --device, --validate; defaults as they are.
void add_capture_options(CLI::App& command, CapturePicture& picture);

// What the reference on the CPU is among the techniques.
TechniqueInfo cpu_technique();

// Names of --sync, the fastest first after `automatic`.
std::vector<std::pair<std::string, Sync>> sync_names();

struct Size {
  std::uint32_t width = 0, height = 0;
};
// "1280x720". Throws Error{bad_argument}.
Size parse_size(const std::string& text);

}  // namespace pellucid::cli
