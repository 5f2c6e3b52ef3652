// Joints, weights and morph targets of a primitive: see gltf_deformation.h. Format: glTF 2.0, section 3.7.
#include "asset/gltf_deformation.h"

#include <algorithm>
#include <cmath>

#include "asset/component.h"

namespace pellucid {
namespace {

constexpr std::size_t kJointsOfSet = 4;

void expect_count(const Fields& fields, const char* what, std::uint64_t count, std::uint64_t vertices) {
  if (count == vertices) return;
  fields.fail("it has " + std::to_string(count) + " " + what + " for " + std::to_string(vertices) +
              " positions");
}

void read_joint_set(const Fields& fields, std::size_t set, AccessorReader& accessors,
                    std::vector<VertexJoints>& vertices) {
  const std::string suffix = std::to_string(set);
  const Fields attributes = fields.object("attributes");
  const std::uint64_t joints_accessor = attributes.index(("JOINTS_" + suffix).c_str());
  const std::uint64_t weights_accessor = attributes.index(("WEIGHTS_" + suffix).c_str());
  expect_count(fields, "joints", accessors.count(joints_accessor), vertices.size());
  expect_count(fields, "weights", accessors.count(weights_accessor), vertices.size());

  const AccessorReader::Elements joints = accessors.read_elements(joints_accessor);
  const bool fits = joints.component_type == unsigned_byte || joints.component_type == unsigned_short;
  if (joints.type != "VEC4" || !fits || joints.normalized) {
    accessors.accessor(joints_accessor).fail("joints are not four unsigned 8- or 16-bit integers");
  }
  const std::vector<float> weights = read_reals(weights_accessor, "VEC4", accessors);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (std::size_t k = 0; k < kJointsOfSet; ++k) {
      const float weight = weights[kJointsOfSet * v + k];
      if (!(weight >= 0) || !std::isfinite(weight)) {
        accessors.accessor(weights_accessor)
            .fail("a weight of vertex " + std::to_string(v) + " is negative or not finite");
      }
      const std::size_t at = v * joints.element_bytes + k * joints.component_bytes;
      vertices[v].joints[kJointsOfSet * set + k] =
          static_cast<std::uint16_t>(scalar_at(joints.bytes, at, joints.component_type));
      vertices[v].weights[kJointsOfSet * set + k] = weight;
    }
  }
}

std::vector<VertexJoints> read_joints(const Fields& fields, std::uint64_t vertices,
                                      AccessorReader& accessors) {
  const Fields attributes = fields.object("attributes");
  if (!attributes.has("JOINTS_0") && !attributes.has("WEIGHTS_0")) return {};
  std::vector<VertexJoints> joints(vertices);
  read_joint_set(fields, 0, accessors, joints);
  if (attributes.has("JOINTS_1") || attributes.has("WEIGHTS_1")) read_joint_set(fields, 1, accessors, joints);
  for (VertexJoints& vertex : joints) vertex = normalized(vertex);
  return joints;
}

std::vector<Vec3f> read_target(const Fields& fields, std::uint64_t target, std::uint64_t vertices,
                               AccessorReader& accessors) {
  const auto positions = fields.element("targets", target).find_index("POSITION");
  if (!positions) return {};
  expect_count(fields.element("targets", target), "positions", accessors.count(*positions), vertices);
  std::vector<Vec3f> deltas = accessors.read_vec3(*positions);
  for (std::size_t v = 0; v < deltas.size(); ++v) {
    const Vec3f& delta = deltas[v];
    if (!std::isfinite(delta.x) || !std::isfinite(delta.y) || !std::isfinite(delta.z))
      accessors.accessor(*positions).fail("element " + std::to_string(v) + " is not finite");
  }
  return deltas;
}

}  // namespace

VertexJoints normalized(VertexJoints joints) {
  struct Pair {
    float weight = 0;
    std::uint16_t joint = 0;
  };
  std::array<Pair, kJointsOfVertex> pairs;
  double sum = 0;
  for (std::size_t k = 0; k < kJointsOfVertex; ++k) {
    sum += joints.weights[k];
    // Writers leave anything in the joints that have no weight.
    if (joints.weights[k] > 0) pairs[k] = {joints.weights[k], joints.joints[k]};
  }
  if (!(sum > 0)) return {{}, {1.0F}};
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
  });
  for (std::size_t k = 0; k < kJointsOfVertex; ++k) {
    joints.joints[k] = pairs[k].joint;
    joints.weights[k] = static_cast<float>(pairs[k].weight / sum);
  }
  return joints;
}

std::vector<float> read_reals(std::uint64_t accessor, const std::string& type, AccessorReader& accessors) {
  const AccessorReader::Elements source = accessors.read_elements(accessor);
  const Fields fields = accessors.accessor(accessor);
  if (source.type != type) fields.fail("type is " + source.type + ", not " + type);
  const bool integers = source.component_type != single_float;
  if (integers && (!source.normalized || source.component_bytes > 2))
    fields.fail("it holds neither floats nor normalised 8- or 16-bit integers");
  std::vector<float> values(source.count() * source.components);
  for (std::size_t i = 0; i < source.count(); ++i) {
    for (std::size_t k = 0; k < source.components; ++k) {
      values[i * source.components + k] =
          real_at(source.bytes, i * source.element_bytes + k * source.component_bytes, source.component_type,
                  source.normalized);
    }
  }
  return values;
}

std::ptrdiff_t find_non_finite(std::span<const float> values) {
  const auto found = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
  return found == values.end() ? -1 : found - values.begin();
}

RigPrimitive read_deformation(const Fields& fields, std::uint64_t vertices, AccessorReader& accessors) {
  RigPrimitive primitive;
  primitive.joints = read_joints(fields, vertices, accessors);
  for (std::uint64_t t = 0; t < fields.size("targets"); ++t) {
    primitive.targets.push_back(read_target(fields, t, vertices, accessors));
  }
  return primitive;
}

}  // namespace pellucid
