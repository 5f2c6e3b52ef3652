// blending_techniques.h - techniques that deliver no list of fragments: they blend while they draw.
#pragma once

#include "technique.h"

namespace pellucid::render {

TechniqueEntry plain_blend();

}  // namespace pellucid::render
