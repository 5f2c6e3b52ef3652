// gpu_scene.h - copies a RenderScene to the device. Triangles go in, buffers and the ranges to draw come out.
//
// Triangles are rotated so that their smallest corner comes first. Two coincident triangles then get the same
// depths to the bit, however their corners were listed. Translucent triangles are drawn first, the
// double-sided ones before the others. Opaque triangles follow in falling order of their ids, so that the
// smallest id is drawn last and wins where depths are equal.
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
  bool cut_out = false;  // some triangles have fragments that are cut out
};

// Triangles that are neighbours in the draw order, with their bounding box. The box is enlarged by more than
// the rounding of rasterisation.
struct TriangleGroup {
  DrawRange range;
  Vec3f low, high;
};

struct GpuScene {
  Buffer positions, normals;
  Buffer indices;
  Buffer triangles;   // in draw order: object, and number of the triangle in the RenderScene
  Buffer objects;     // object of every triangle of the RenderScene
  Buffer surfaces;    // GpuSurface
  Buffer attributes;  // per vertex: texture coordinates and colour; empty if all are white
  Buffer textures;    // words of shaders/scene/texture.glsl; empty without textures
  std::vector<DrawRange> all_ranges;
  std::vector<DrawRange> ranges;  // those that a pass draws: see draw_all() and draw_only()
  std::vector<TriangleGroup> all_groups;
  std::vector<TriangleGroup> groups;  // the same triangles as `ranges`
  std::uint32_t object_count = 0;

  // Draws back faces of one-sided surfaces as well, until draw_all() or draw_only().
  void draw_both_sides();
  void draw_all();
  void draw_only(bool opaque);
  [[nodiscard]] bool has_opaque() const;
  // Returns the features of what a pass draws: a sum of Feature (frame.h).
  [[nodiscard]] std::uint32_t features() const;
};

// A surface as shaders/scene/fragment_input.glsl reads it (std430).
struct GpuSurface {
  std::array<float, 4> color{};  // colour and alpha
  std::uint32_t texture = 0;     // 0xFFFFFFFF: no texture
  float cutoff = 0;
  std::uint32_t opaque = 0, unlit = 0;
  std::array<float, 3> emissive{};
  std::uint32_t emissive_texture = 0;  // 0xFFFFFFFF: no texture
};

// Checks the scene and copies it. Throws Error{bad_argument} if its members do not fit together.
GpuScene upload_scene(Context& context, const RenderScene& scene);

}  // namespace pellucid::render
