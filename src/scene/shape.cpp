// Primitives as they are posed: see shape.h.
#include "scene/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pellucid/subdivide.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// Vertices at one place that differ otherwise; beyond these nothing is welded there.
constexpr int kMostVariants = 8;
// Sum of differences of joint weights that quantisation may leave on both sides of a seam.
constexpr double kSameWeights = 0.02;

double weight_of(const VertexJoints& vertex, std::uint16_t joint) {
  double weight = 0;
  for (std::size_t k = 0; k < kJointsOfVertex; ++k) {
    if (vertex.joints[k] == joint) weight += vertex.weights[k];
  }
  return weight;
}

bool follow_the_same(const VertexJoints& a, const VertexJoints& b) {
  if (a == b) return true;
  double difference = 0;
  for (std::size_t k = 0; k < kJointsOfVertex; ++k) {
    if (a.weights[k] > 0) difference += std::abs(weight_of(a, a.joints[k]) - weight_of(b, a.joints[k]));
    if (b.weights[k] > 0) difference += std::abs(weight_of(a, b.joints[k]) - weight_of(b, b.joints[k]));
  }
  // Joints of both are counted twice.
  return difference <= 2 * kSameWeights;
}

bool move_alike(const RigPrimitive& deformation, std::uint32_t a, std::uint32_t b) {
  if (!deformation.joints.empty() && !follow_the_same(deformation.joints[a], deformation.joints[b]))
    return false;
  return std::all_of(deformation.targets.begin(), deformation.targets.end(),
                     [&](const auto& target) { return target.empty() || target[a] == target[b]; });
}

// Parts that touch at rest and move apart are not one surface.
std::vector<std::uint32_t> weld_alike(const Mesh& mesh, const RigPrimitive& deformation) {
  std::vector<std::uint32_t> weld = weld_by_position(mesh.positions);
  if (deformation.joints.empty() && deformation.targets.empty()) return weld;
  std::vector<std::uint32_t> next_variant(weld.size(), kNone);
  for (std::uint32_t v = 0; v < weld.size(); ++v) {
    std::uint32_t variant = weld[v];
    if (variant == v) continue;
    int tried = 1;
    while (!move_alike(deformation, v, variant) && next_variant[variant] != kNone) {
      variant = next_variant[variant];
      ++tried;
    }
    if (move_alike(deformation, v, variant)) {
      weld[v] = variant;
      continue;
    }
    weld[v] = v;
    if (tried < kMostVariants) next_variant[variant] = v;
  }
  return weld;
}

// The heaviest of all joints that a refined vertex's control vertices follow.
VertexJoints refined_joints(const Subdivision& subdivision, std::uint32_t vertex,
                            const std::vector<VertexJoints>& joints) {
  struct Pull {
    double weight = 0;
    std::uint16_t joint = 0;
  };
  std::vector<Pull> pulls;
  for (std::uint32_t i = subdivision.first[vertex]; i < subdivision.first[vertex + 1]; ++i) {
    const VertexJoints& control = joints[subdivision.control[i]];
    for (std::size_t k = 0; k < kJointsOfVertex && control.weights[k] > 0; ++k) {
      const std::uint16_t joint = control.joints[k];
      auto pull = std::find_if(pulls.begin(), pulls.end(), [&](const Pull& p) { return p.joint == joint; });
      if (pull == pulls.end()) pull = pulls.insert(pull, {0, joint});
      pull->weight += subdivision.weights[i] * control.weights[k];
    }
  }
  std::sort(pulls.begin(), pulls.end(), [](const Pull& a, const Pull& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
  });
  VertexJoints result;
  for (std::size_t k = 0; k < std::min(pulls.size(), kJointsOfVertex); ++k) {
    result.joints[k] = pulls[k].joint;
    result.weights[k] = static_cast<float>(pulls[k].weight);
  }
  return normalized(result);
}

std::vector<std::uint16_t> followed_joints(const std::vector<VertexJoints>& vertices) {
  std::vector<bool> followed(std::numeric_limits<std::uint16_t>::max() + std::size_t{1}, false);
  for (const VertexJoints& vertex : vertices) {
    for (std::size_t k = 0; k < kJointsOfVertex && vertex.weights[k] > 0; ++k) {
      followed[vertex.joints[k]] = true;
    }
  }
  std::vector<std::uint16_t> joints;
  for (std::size_t joint = 0; joint < followed.size(); ++joint) {
    if (followed[joint]) joints.push_back(static_cast<std::uint16_t>(joint));
  }
  return joints;
}

Shape refined_shape(const Mesh& mesh, const RigPrimitive& deformation, std::uint32_t subdivisions) {
  Subdivision subdivision = subdivide_loop(mesh.triangles, weld_alike(mesh, deformation), subdivisions);
  Shape shape;
  shape.positions = refined_values(subdivision, mesh.positions);
  if (!deformation.joints.empty()) {
    shape.deformation.joints.resize(subdivision.vertices());
    for (std::uint32_t v = 0; v < subdivision.vertices(); ++v) {
      shape.deformation.joints[v] = refined_joints(subdivision, v, deformation.joints);
    }
  }
  for (const std::vector<Vec3f>& target : deformation.targets) {
    shape.deformation.targets.push_back(target.empty() ? target : refined_values(subdivision, target));
  }
  shape.triangles = std::move(subdivision.triangles);
  return shape;
}

}  // namespace

Shape make_shape(const Mesh& mesh, RigPrimitive deformation, std::uint32_t subdivisions) {
  Shape shape = subdivisions == 0 ? Shape{mesh.triangles, mesh.positions, std::move(deformation), {}}
                                  : refined_shape(mesh, deformation, subdivisions);
  shape.joints = followed_joints(shape.deformation.joints);
  return shape;
}

}  // namespace pellucid
