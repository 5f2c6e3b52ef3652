// Makes meshes and cameras, and compares fragments, for the tests of the raster.
#pragma once

#include <algorithm>
#include <cstring>

#include "meshes.h"
#include "pellucid/raster.h"

namespace pellucid::testing {

// Returns an orthographic camera that looks along -z at the square [-1, 1]^2 from z = 1. Image x runs along x
// and image y against y, and the depth is (1 - z) / 2.
inline Camera front_camera(std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.eye = {0, 0, 1};
  camera.right = {1, 0, 0};
  camera.up = {0, 1, 0};
  camera.forward = {0, 0, -1};
  camera.perspective = false;
  camera.half_height = 1;
  camera.near_plane = 0;
  camera.far_plane = 2;
  camera.width = width;
  camera.height = height;
  return camera;
}

// Returns a closed sphere with a varying radius, of `segments` by 2 `segments` quads.
inline Mesh wrinkled_sphere(std::uint32_t segments, double wrinkle) {
  Mesh mesh;
  const std::uint32_t rings = segments;
  const std::uint32_t columns = 2 * segments;
  const auto put = [&](double theta, double phi) {
    const double r = 1.0 - wrinkle + wrinkle * std::sin(5 * theta) * std::sin(7 * phi);
    mesh.positions.push_back(to_float(Vec3d{r * std::sin(theta) * std::cos(phi), r * std::cos(theta),
                                            -r * std::sin(theta) * std::sin(phi)}));
  };
  constexpr double kPi = 3.14159265358979323846;
  put(0, 0);
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) put(kPi * i / rings, 2 * kPi * j / columns);
  }
  put(kPi, 0);
  const auto at = [&](std::uint32_t ring, std::uint32_t column) {
    return 1 + (ring - 1) * columns + column % columns;
  };
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t j = 0; j < columns; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    mesh.triangles.push_back({at(rings - 1, j), last, at(rings - 1, j + 1)});
  }
  return mesh;
}

inline FragmentBuffer fragments_of(const Mesh& mesh, const Camera& camera, Culling culling = Culling::none) {
  FragmentBuffer out;
  rasterize(mesh, camera, {culling}, out);
  return out;
}

inline bool same_bytes(const FragmentBuffer& a, const FragmentBuffer& b) {
  return a.width == b.width && a.height == b.height && a.offsets == b.offsets &&
         a.fragments.size() == b.fragments.size() &&
         (a.fragments.empty() ||
          std::memcmp(a.fragments.data(), b.fragments.data(), a.fragments.size() * sizeof(Fragment)) == 0);
}

}  // namespace pellucid::testing
