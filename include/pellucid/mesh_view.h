// pellucid/mesh_view.h - refers to the arrays of a caller's mesh, for the functions of pellucid/pellucid.h.
//
// In: positions and indices in one of several layouts. Out: views of them, and copy_mesh(), which copies them
// into a Mesh. A view refers to the caller's memory, which must exist until the call that takes the view has
// returned. The library keeps no view.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pellucid/base.h"
#include "pellucid/mesh.h"

namespace pellucid {

// Refers to vertex positions: contiguous Vec3f, contiguous floats x y z x y z ..., or floats with a stride.
class PositionView {
 public:
  PositionView() = default;
  template <std::convertible_to<std::span<const Vec3f>> Range>
  PositionView(const Range& positions) {
    const std::span<const Vec3f> span = positions;
    *this = PositionView(span.empty() ? nullptr : &span.front().x, span.size());
  }
  // Throws Error{bad_argument} unless the number of floats is a multiple of 3.
  template <std::convertible_to<std::span<const float>> Range>
  PositionView(const Range& xyz) {
    *this = of_floats(xyz);
  }
  // `stride_bytes` is the distance from one vertex to the next. Throws Error{bad_argument} for a null pointer
  // if `vertices` is not 0, and for a stride that is less than 12 or not a multiple of 4.
  PositionView(const float* first, std::size_t vertices, std::size_t stride_bytes = sizeof(Vec3f));

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Vec3f operator[](std::size_t vertex) const {
    const float* at = first_ + vertex * floats_;
    return {at[0], at[1], at[2]};
  }

 private:
  static PositionView of_floats(std::span<const float> xyz);
  const float* first_ = nullptr;
  std::size_t size_ = 0, floats_ = 3;
};

// Refers to indices, three for each triangle, as 32-bit numbers, 16-bit numbers or Triangles.
class IndexView {
 public:
  IndexView() = default;
  template <std::convertible_to<std::span<const std::uint32_t>> Range>
  IndexView(const Range& indices) : wide_(indices) {}
  template <std::convertible_to<std::span<const std::uint16_t>> Range>
  IndexView(const Range& indices) : narrow_(indices) {}
  template <std::convertible_to<std::span<const Triangle>> Range>
  IndexView(const Range& triangles) : triangles_(triangles) {}

  [[nodiscard]] std::size_t size() const { return wide_.size() + narrow_.size() + 3 * triangles_.size(); }
  [[nodiscard]] std::uint32_t operator[](std::size_t i) const {
    if (!wide_.empty()) return wide_[i];
    return narrow_.empty() ? triangles_[i / 3][i % 3] : narrow_[i];
  }

 private:
  std::span<const std::uint32_t> wide_;
  std::span<const std::uint16_t> narrow_;
  std::span<const Triangle> triangles_;
};

// Refers to a whole mesh.
struct MeshView {
  PositionView positions;
  IndexView indices;
};

// A key frame of an animated mesh: the positions of all its vertices at a time.
struct Pose {
  double time = 0;  // seconds
  PositionView positions;
};

// Returns a copy of the arrays. Throws Error{bad_argument} if the number of indices is not a multiple of 3,
// or if there are 2^32 - 1 vertices or more, or 2^31 triangles or more. Indices may be out of range.
Mesh copy_mesh(const MeshView& mesh);

}  // namespace pellucid
