// Subdivided icosahedra, with the numbering and the very vertices of pellucid/runtime/select.h.
#include <algorithm>
#include <unordered_map>

#include "pellucid/runtime/select.h"
#include "pellucid/view.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kMaxIcosphereLevel = 9;  // S[5,4] needs its 2.6 million vertices

using Corners = std::array<std::uint32_t, 3>;

Icosphere make_icosahedron() {
  Icosphere sphere;
  for (const auto& v : pellucid_base_vertices) sphere.vertices.push_back({v[0], v[1], v[2]});
  for (const auto& f : pellucid_base_faces) sphere.triangles.push_back({f[0], f[1], f[2]});
  return sphere;
}

Vec3d midpoint(const Vec3d& a, const Vec3d& b) {
  const std::array<double, 3> first{a.x, a.y, a.z};
  const std::array<double, 3> second{b.x, b.y, b.z};
  std::array<double, 3> middle{};
  pellucid_midpoint(first.data(), second.data(), middle.data());
  return {middle[0], middle[1], middle[2]};
}

// Splits edges, each once.
class EdgeSplitter {
 public:
  explicit EdgeSplitter(Icosphere& sphere) : sphere_(sphere) {
    middles_.reserve(sphere.triangles.size() * 2);
  }

  std::uint32_t split(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t edge = (std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b);
    const auto [entry, is_new] =
        middles_.try_emplace(edge, static_cast<std::uint32_t>(sphere_.vertices.size()));
    if (is_new) sphere_.vertices.push_back(midpoint(sphere_.vertices[a], sphere_.vertices[b]));
    return entry->second;
  }

 private:
  Icosphere& sphere_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

void subdivide(Icosphere& sphere) {
  EdgeSplitter splitter(sphere);
  std::vector<Corners> children;
  children.reserve(sphere.triangles.size() * 4);
  for (const auto& [c0, c1, c2] : sphere.triangles) {
    const std::uint32_t m12 = splitter.split(c1, c2);
    const std::uint32_t m20 = splitter.split(c2, c0);
    const std::uint32_t m01 = splitter.split(c0, c1);
    children.push_back({c0, m01, m20});
    children.push_back({m01, c1, m12});
    children.push_back({m20, m12, c2});
    children.push_back({m12, m20, m01});
  }
  sphere.triangles = std::move(children);
}

}  // namespace

Icosphere make_icosphere(std::uint32_t level) {
  if (level > kMaxIcosphereLevel) {
    throw Error(ErrorKind::bad_argument, "icosphere level " + std::to_string(level) + " is out of range 0.." +
                                             std::to_string(kMaxIcosphereLevel));
  }
  Icosphere sphere = make_icosahedron();
  for (std::uint32_t i = 0; i < level; ++i) subdivide(sphere);
  return sphere;
}

}  // namespace pellucid
