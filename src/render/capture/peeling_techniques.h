// peeling_techniques.h - techniques that take a picture apart layer by layer, from the front or from both
// ends.
//
// All compare depths that come the same way: what the depth test left with gl_FragCoord.z, or, where there is
// none, bits of gl_FragCoord.z with such bits in a buffer. A pixel without a further layer is known by what a
// round did not deliver, never by a depth: 1 is one like any other.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// Front to back, with the depth test (front_to_back.cpp).
TechniqueEntry f2b();
TechniqueEntry f2b2();
TechniqueEntry f2b_3p();
TechniqueEntry f2b_ll();
TechniqueEntry f2b_kb();
TechniqueEntry f2b_fab();

// Without depth test, front to back or from both ends (dual_peeling.cpp).
TechniqueEntry f2b_2p();
TechniqueEntry dual();
TechniqueEntry dual_2p();
TechniqueEntry dual_ll();
TechniqueEntry dual_kb();
TechniqueEntry dual_fab();

}  // namespace pellucid::render
