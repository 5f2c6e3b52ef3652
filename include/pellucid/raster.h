// pellucid/raster.h - rasterises every fragment of every pixel on the CPU, in depth order.
//
// In: a mesh and a camera. Out: a list of fragments per pixel, sorted by depth and node. It is the reference
// for all other modules.
//
// The result has the same bits for any number of threads. As on a GPU, vertices snap to a fixed-point grid of
// 1/256 pixel, and coverage is decided by exact integer edge functions with the top-left rule, by which a
// point on a shared edge belongs to exactly one of two neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

// A pinhole or orthographic camera in object space. Pixel (0, 0) is the upper left one.
struct Camera {
  Vec3d eye;                 // for an orthographic camera, any point on the axis of the image
  Vec3d right, up, forward;  // orthonormal; forward looks into the scene
  bool perspective = true;
  // Perspective: tan(vertical field of view / 2). Orthographic: half the height of the image in object units.
  double half_height = 1;
  // Distances along `forward`. 0 < near_plane < far_plane for perspective cameras.
  double near_plane = 0;
  double far_plane = 1;
  std::uint32_t width = 512, height = 512;  // pixels
};
// Returns a camera at the viewpoint that looks at the centre of the sphere. The sphere just fits into the
// shorter side of the image. The up axis is +y, or +z if the camera looks along +-y.
Camera look_at_sphere(const BoundingSphere& sphere, const Viewpoint& viewpoint, std::uint32_t width,
                      std::uint32_t height);

// A camera position in homogeneous coordinates. w = 1: the point `at`. w = 0: infinitely far away in
// direction `at`.
struct Eye {
  Vec3d at;
  double w = 1;
};
// Returns the position of a viewpoint in object space.
Eye eye_of(const BoundingSphere& sphere, const Viewpoint& viewpoint);

// One triangle at one pixel centre.
struct Fragment {
  // 0 (near plane) to 1 (far plane). Perspective: (1/near - 1/z) / (1/near - 1/far). Orthographic: (z - near)
  // / (far - near). Both are linear over a triangle in screen space.
  float depth;
  std::uint32_t node;  // 2 * triangle + (0: front-facing, 1: back-facing)
};

struct RasterMemory;  // opaque

// The fragments of an image.
struct FragmentBuffer {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t> offsets;  // width * height + 1
  // Pixel p = y * width + x has fragments[offsets[p] .. offsets[p + 1]), sorted by (depth, node) from front
  // to back.
  std::vector<Fragment> fragments;
  [[nodiscard]] std::span<const Fragment> pixel(std::uint64_t p) const {
    return {fragments.data() + offsets[p], static_cast<std::size_t>(offsets[p + 1] - offsets[p])};
  }
  // Returns the number of pixels with at least one fragment.
  [[nodiscard]] std::uint64_t covered_pixels() const;

  // Working memory that the next rasterize() into this buffer reuses. A copy of the buffer gets its own.
  std::shared_ptr<RasterMemory> memory{};
};

// With `back`, only front-facing triangles make fragments.
enum class Culling { none, back };

struct RasterOptions {
  Culling culling = Culling::none;
};
// Writes all fragments of `mesh` to `out` and reuses its memory. Clips triangles at the near and far planes.
// Triangles that have no area after snapping, or a corner that is not finite, make no fragments. The indices
// of the mesh must be in range. Takes O(triangles + fragments * log(depth complexity)) time, and 8 bytes per
// fragment and per pixel. Throws Error{bad_argument} for an image of no pixels, of more than 2^28 pixels or
// of more than 2^20 pixels per side, and for a camera whose planes or half_height are invalid.
void rasterize(const Mesh& mesh, const Camera& camera, const RasterOptions& options, FragmentBuffer& out);

}  // namespace pellucid
