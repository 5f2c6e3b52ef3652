// gpu_scene.h - copies a RenderScene to the device. Triangles go in, buffers and the ranges to draw come out.
//
// Triangles are rotated so that their smallest corner comes first: two that coincide then get the same depths
// to the bit, however their corners were listed. Translucent triangles come first, among them the
// double-sided ones before the others. Opaque ones follow from the last to the first, so that of several at
// one depth the one of the smallest id is drawn over the others.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/device/memory.h"

namespace pellucid::render {

struct DrawRange {
  std::uint32_t first_triangle = 0, triangles = 0;
  bool culled = false;  // back faces are not drawn
  bool opaque = false;
  bool cut_out = false;  // of some triangles fragments are cut out
};

// Neighbours in the draw order, with a box that is somewhat larger than they are: more than what
// rasterisation rounds.
struct TriangleGroup {
  DrawRange range;
  Vec3f low, high;
};

struct GpuScene {
  Buffer positions, normals;
  Buffer indices;
  Buffer triangles;   // as drawn: object, number of the triangle in the RenderScene
  Buffer objects;     // of the RenderScene's triangles
  Buffer surfaces;    // GpuSurface
  Buffer attributes;  // of vertices: texture coordinates and colour; none where all are white
  Buffer textures;    // words: shaders/scene/texture.glsl; none without textures
  std::vector<DrawRange> all_ranges;
  std::vector<DrawRange> ranges;  // of these, what a pass draws: see draw_all() and the others
  std::vector<TriangleGroup> all_groups;
  std::vector<TriangleGroup> groups;  // the same triangles as `ranges`
  std::uint32_t object_count = 0;

  void draw_all();
  void draw_only(bool opaque);
  [[nodiscard]] bool has_opaque() const;
  // Of what a pass draws: a sum of Feature (frame.h).
  [[nodiscard]] std::uint32_t features() const;
};

// std430, shaders/scene/fragment_input.glsl
struct GpuSurface {
  std::array<float, 4> color{};  // and alpha
  std::uint32_t texture = 0;     // 0xFFFFFFFF: none
  float cutoff = 0;
  std::uint32_t opaque = 0, unused = 0;
};

// Throws Error{bad_argument} for members that do not fit together.
GpuScene upload_scene(Context& context, const RenderScene& scene);

}  // namespace pellucid::render
