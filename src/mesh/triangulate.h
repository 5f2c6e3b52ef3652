// Internal to the module `mesh`: convex polygons to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

// Append the triangles of a convex polygon, as positions in `corners`. Corners may lie on a line: of all
// triangulations it is one whose thinnest triangle is thickest, so that none is without area where that can
// be had. O(n^3) up to 32 corners, then O(n^2).
void triangulate_convex(std::span<const Vec3d> corners, const Vec3d& normal,
                        std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace pellucid
