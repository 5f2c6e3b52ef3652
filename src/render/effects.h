// effects.h - the effects' numbers are those of shaders/resolve/effects.glsl.
#pragma once

#include "pellucid/render.h"

namespace pellucid::render {

// Objects that the state of an effect has room for.
std::uint32_t most_objects(Effect effect);

}  // namespace pellucid::render
