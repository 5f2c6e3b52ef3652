// From where does one face hide a part of another?
//
// Let A be the part of the front face before the plane of the other, B the part of the other behind the plane
// of the front face. The line from y in B to x in A goes on to the viewpoints x + t (x - y), t >= 0. Together
// these are A + cone(A - B): a convex set, the intersection of the half-spaces of all planes that separate A
// from B and touch both (with A in front). From all its points both faces turn their fronts, and from no
// other point A hides B. Chen, Sander, Nehab, Yang, Hu, "Depth-presorted triangle lists", SIGGRAPH Asia 2012,
// call it the occlusion region.
#pragma once

#include <array>

#include "transparency/graph/view_solid.h"

namespace pellucid {

// One facing of a triangle, in bounding radii about the sphere's centre.
struct SolidFace {
  std::array<Vec3d, 3> corners;
  HalfSpace front;
  // Seen under a smaller angle than this (radians) a face is edge-on and neither hides nor is hidden.
  double edge_on = 0;
};

// `viewpoints` becomes the part of the solid's frustum from which `front` hides a part of `back`. Never too
// small but for what lies within `edge_on` of a face's plane, and for parts nearer to the other face's plane
// than 1e-7.
void find_hiding_viewpoints(const ViewSolid& solid, const SolidFace& front, const SolidFace& back,
                            ViewPolytope& viewpoints);

}  // namespace pellucid
