// Options of techniques with a pool or a memory budget (pellucid/memory_budget.h). They are added to a
// command and read into RenderOptions.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "pellucid/render.h"

namespace pellucid::cli {

// Adds --pool, --device-memory, --overflow, --allocation, --importance and the parameters of its terms.
// `image` receives the path of --importance-image, which read_importance() reads.
void add_budget_options(CLI::App& command, RenderOptions& options, std::string& image);
// Reads an importance image. Returns an empty one for an empty path. Throws as read_image() does.
ImportanceImage read_importance(const std::string& path);

// Parses "35MB", "20MiB" or "4096" as bytes. Units are powers of ten or, with an i, of two. Throws
// Error{bad_argument}.
std::uint64_t parse_bytes(const std::string& option, const std::string& text);

// Writes importance.png, k.png and loss.png into `folder`, which is created. Throws Error{cannot_write}.
void write_maps(const RenderResult& result, std::uint32_t samples, const std::string& folder);

}  // namespace pellucid::cli
