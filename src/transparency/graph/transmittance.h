// How much light reaches a face through what is in front of it: what an error there can be seen of.
//
// With faces of opacity alpha a fragment behind n others contributes (1 - alpha)^n of its colour: an overlap
// in the wrong order matters by that share of its area.
#pragma once

#include <vector>

#include "pellucid/raster.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {

constexpr float kNoLightKnown = -1;

// Per triangle, `light` being as long as there are any: the mean of (1 - alpha)^(fragments in front) over its
// fragments, kNoLightKnown where it has none. From one viewpoint a triangle shows one facing only.
void find_light_of_triangles(const FragmentBuffer& fragments, double alpha, std::vector<float>& light);

// The same for all triangles that the viewpoint sees, by a small picture: one that no pixel centre meets
// looks at the pixel of its middle. O(triangles + fragments). `fragments` is scratch memory.
void find_light(const OcclusionScene& scene, const Viewpoint& viewpoint, const ScreenTriangles& screen,
                FragmentBuffer& fragments, std::vector<float>& light);

}  // namespace pellucid
