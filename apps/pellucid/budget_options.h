// Options of techniques with a budget of bytes (pellucid/budget.h).
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "pellucid/render.h"

namespace pellucid::cli {

// --memory, --allocation, --importance and what its terms go by.
// `image`: the path of --importance-image, which read_importance() reads; nothing where it is empty.
void add_budget_options(CLI::App& command, RenderOptions& options, std::string& image);
ImportanceImage read_importance(const std::string& path);

// "35MB", "20MiB", "4096": bytes; powers of ten or, with an i, of two. Throws Error{bad_argument}.
std::uint64_t parse_bytes(const std::string& option, const std::string& text);

// Throws Error{bad_argument} for techniques without maps: before anything is drawn.
void check_maps(const std::string& technique);
// importance.png, k.png and loss.png in `folder`, which is made. Throws Error{cannot_write}.
void write_maps(const RenderResult& result, std::uint32_t samples, const std::string& folder);

}  // namespace pellucid::cli
