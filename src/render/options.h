// options.h - what the library's own code asks of options: their ranges, and what their values mean. It does
// not need Vulkan, unlike checks.h.
#pragma once

#include <cstddef>

#include "pellucid/render.h"

namespace pellucid::render {

// Throws Error{bad_argument} where the state of an effect cannot tell `objects` objects apart.
void check_effect(Effect effect, std::size_t objects);

// Returns whether the effect blends colours in depth order, so that nothing behind an opaque surface matters.
bool blends(Effect effect);

// Throws Error{bad_argument} for parameters that are not numbers or out of range, and for an importance image
// whose bytes do not match its size.
void check_importance(const ImportanceOptions& options);

}  // namespace pellucid::render
