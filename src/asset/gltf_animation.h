// Internal to the module `asset`: glTF animations become channels and curves.
#pragma once

#include "asset/accessor_reader.h"
#include "pellucid/animation.h"

namespace pellucid {

// Fill rig.animations and rig.curves; rig.nodes are there.
void read_animations(const Fields& root, AccessorReader& accessors, Rig& rig);

}  // namespace pellucid
