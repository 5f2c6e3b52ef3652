// gpu_scene.h - a RenderScene on the device.
//
// Triangles are rotated so that their smallest corner comes first: two that coincide then get the same depths
// to the bit, however their corners were listed. Those that show both sides come first, then those that are
// culled.
#pragma once

#include <cstdint>
#include <vector>

#include "device/memory.h"

namespace pellucid::render {

struct DrawRange {
  std::uint32_t first_triangle = 0, triangles = 0;
  bool culled = false;  // back faces are not drawn
};

struct GpuScene {
  Buffer positions, normals;
  Buffer indices;
  Buffer triangles;  // as drawn: object, number of the triangle in the RenderScene
  Buffer objects;    // of the RenderScene's triangles
  Buffer surfaces;   // colour and alpha
  std::vector<DrawRange> ranges;
  std::uint32_t object_count = 0;
};

// Throws Error{bad_argument} for members that do not fit together.
GpuScene upload_scene(Context& context, const RenderScene& scene);

}  // namespace pellucid::render
