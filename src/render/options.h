// options.h - checks of options that need no device, and what effects have in common. The CPU reference and
// the renderer both use them.
#pragma once

#include <cstddef>

#include "pellucid/render.h"

namespace pellucid::render {

// Throws Error{bad_argument} if the effect cannot distinguish `objects` objects.
void check_effect(Effect effect, std::size_t objects);

// Returns whether the effect blends colours in depth order, so that nothing behind an opaque surface matters.
bool blends(Effect effect);
// Returns whether the effect asks where rays enter and leave solids. It sees both sides of all faces.
bool cuts_solids(Effect effect);

// Throws Error{bad_argument} for parameters that are not numbers or out of range, and for an importance image
// whose bytes do not match its size.
void check_importance(const ImportanceOptions& options);

}  // namespace pellucid::render
