// nearest_rounds.h - the nearest fragments of every pixel in a pool that is too small for all, again and
// again behind the last ones (MultiKB), or once: what techniques that store in a pool turn to when it does
// not suffice.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// In RenderOptions::pool places; needs 64-bit atomics.
std::unique_ptr<Technique> nearest_rounds_in_pool(Overflow overflow);

}  // namespace pellucid::render
