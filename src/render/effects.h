// effects.h - the effects' numbers are those of shaders/resolve/effects.glsl.
#pragma once

#include <cstddef>

#include "pellucid/render.h"

namespace pellucid::render {

// Throws Error{bad_argument} where the state of an effect has no room for so many objects.
void check_effect(Effect effect, std::size_t objects);

// Does it blend colours in depth order? Then nothing behind an opaque surface matters.
bool blends(Effect effect);

}  // namespace pellucid::render
