// pellucid/raster.h - module `raster`: every fragment of every pixel, in depth order, on the CPU.
//
// In: a mesh and a camera. Out: per-pixel lists of fragments sorted by (depth, triangle). It is the oracle
// of everything below, so it is deterministic to the bit for any number of threads: vertices snap to a
// fixed-point grid of 1/256 pixel, coverage is decided by exact integer edge functions with the top-left rule
// (a point on a shared edge belongs to exactly one of two neighbours), as on a GPU.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

// Pinhole or orthographic camera in object space. Pixel (0, 0) is the upper left.
struct Camera {
  Vec3d eye;                 // unused by orthographic cameras except as a point on the image plane's axis
  Vec3d right, up, forward;  // orthonormal; forward looks into the scene
  bool perspective = true;
  double half_height =
      1;  // perspective: tan(vertical field of view / 2); orthographic: half the picture's height
  double near_plane = 0;  // distances along forward, 0 < near < far for perspective
  double far_plane = 1;
  std::uint32_t width = 512, height = 512;
};
// A square or wide picture in which the bounding sphere fits just inside the shorter side.
Camera look_at_sphere(const BoundingSphere& sphere, const Viewpoint& viewpoint, std::uint32_t width,
                      std::uint32_t height);

// Depth in 0..1: perspective (1/near - 1/z) / (1/near - 1/far), orthographic (z - near) / (far - near).
// Linear over a triangle in screen space in both cases.
struct Fragment {
  float depth;
  std::uint32_t node;  // 2 * triangle + (0: front facing, 1: back facing)
};

struct RasterMemory;  // opaque

struct FragmentBuffer {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t> offsets;  // width * height + 1
  std::vector<Fragment> fragments;     // pixel p = y * width + x has fragments[offsets[p] .. offsets[p + 1]),
                                       // sorted by (depth, node): front to back
  [[nodiscard]] std::span<const Fragment> pixel(std::uint64_t p) const {
    return {fragments.data() + offsets[p], static_cast<std::size_t>(offsets[p + 1] - offsets[p])};
  }
  [[nodiscard]] std::uint64_t covered_pixels() const;

  // Working memory that the next rasterize() into this buffer uses again (a copy of the buffer gets its own).
  std::shared_ptr<RasterMemory> memory{};
};

enum class Culling { none, back };  // back: only front-facing triangles make fragments

struct RasterOptions {
  Culling culling = Culling::none;
};
// All fragments of `mesh`. Triangles are clipped at the near and far planes. The buffers of `out` are reused.
// Time O(triangles + fragments * log(depth complexity)); memory 8 bytes a fragment and 8 a pixel.
// Throws Error{bad_argument} for a picture of no pixels, more than 2^28 or more than 2^20 a side, and for a
// camera whose planes or half_height make no sense. Triangles that have no area after snapping, or a corner
// that is not finite, make no fragments.
void rasterize(const Mesh& mesh, const Camera& camera, const RasterOptions& options, FragmentBuffer& out);

}  // namespace pellucid
