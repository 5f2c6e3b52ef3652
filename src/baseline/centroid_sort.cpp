// The sort by centroid that a viewer does in every frame, made fast: see pellucid/baseline.h.
//
// Least-significant-digit radix sort (H. H. Seward, 1954) of (distance as an ordered 32-bit key, triangle).
#include <array>
#include <bit>
#include <cmath>

#include "pellucid/baseline.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

constexpr unsigned kDigitBits = 11;  // three passes over 32 bits, counters that fit the first-level cache
constexpr unsigned kDigitPasses = 3;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr unsigned kKeyShift = 32;  // the key is the upper half

// Floats in the order of their bits as unsigned numbers.
std::uint32_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

std::size_t digit_of(std::uint64_t keyed, unsigned pass) {
  return (keyed >> (kKeyShift + pass * kDigitBits)) & (kDigits - 1);
}

void radix_sort(std::vector<std::uint64_t>& keyed, std::vector<std::uint64_t>& swapped) {
  std::array<std::array<std::uint32_t, kDigits>, kDigitPasses> counts{};
  for (const std::uint64_t k : keyed) {
    for (unsigned pass = 0; pass < kDigitPasses; ++pass) ++counts[pass][digit_of(k, pass)];
  }
  swapped.resize(keyed.size());
  for (unsigned pass = 0; pass < kDigitPasses; ++pass) {
    std::uint32_t place = 0;
    for (std::uint32_t& count : counts[pass]) {
      const std::uint32_t here = count;
      count = place;
      place += here;
    }
    for (const std::uint64_t k : keyed) swapped[counts[pass][digit_of(k, pass)]++] = k;
    std::swap(keyed, swapped);
  }
}

}  // namespace

Eye eye_of(const BoundingSphere& sphere, const Viewpoint& viewpoint) {
  if (std::isinf(viewpoint.distance)) return {viewpoint.direction, 0};
  return {sphere.center + viewpoint.direction * (viewpoint.distance * sphere.radius), 1};
}

CentroidSort::CentroidSort(const Mesh& mesh, const BoundingSphere& sphere) : center_(sphere.center) {
  centroids_.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    Vec3d sum{};
    for (const std::uint32_t v : t) sum += to_double(mesh.positions[v]) - center_;
    centroids_.push_back(to_float(sum / 3.0));
  }
}

void CentroidSort::sort(const Eye& eye, Scratch& scratch, std::vector<std::uint32_t>& triangles) const {
  const bool orthographic = eye.w == 0;
  const Vec3f at = to_float(orthographic ? eye.at : eye.at - center_);
  scratch.keyed.resize(centroids_.size());
  for (std::size_t t = 0; t < centroids_.size(); ++t) {
    const Vec3f to_eye = at - centroids_[t];
    const float distance = orthographic ? -dot(centroids_[t], at) : dot(to_eye, to_eye);
    scratch.keyed[t] = std::uint64_t{ordered_bits(distance)} << kKeyShift | t;
  }
  radix_sort(scratch.keyed, scratch.swapped);
  triangles.resize(scratch.keyed.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles[i] = static_cast<std::uint32_t>(scratch.keyed[i]);
}

NodeSequence centroid_sorted(const Mesh& mesh, const BoundingSphere& sphere, const Viewpoint& viewpoint) {
  const Eye eye = eye_of(sphere, viewpoint);
  CentroidSort::Scratch scratch;
  NodeSequence sequence;
  CentroidSort(mesh, sphere).sort(eye, scratch, sequence);
  for (NodeId& entry : sequence) {
    const Triangle& t = mesh.triangles[entry];
    const Vec3d a = to_double(mesh.positions[t[0]]);
    const Vec3d b = to_double(mesh.positions[t[1]]);
    const Vec3d c = to_double(mesh.positions[t[2]]);
    entry = node_of(entry, dot(cross(b - a, c - a), eye.at - a * eye.w) < 0);
  }
  return sequence;
}

}  // namespace pellucid
