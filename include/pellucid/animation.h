// pellucid/animation.h - module `asset`: reads what moves a glTF model.
//
// In: a model that read_model() returned. Out: its nodes, skins, morph targets and key frames as plain data.
// They are read only on demand, so ordering static meshes does not pay for them. The module `scene`
// (pellucid/scene.h) poses the model. Format: glTF 2.0, sections 3.5, 3.7 and 3.11.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

// The transform of a node relative to its parent: scale, then rotation (quaternion x, y, z, w), then
// translation. If there is a matrix, it replaces the three.
struct NodeTransform {
  Vec3d translation;
  std::array<double, 4> rotation{0, 0, 0, 1};
  Vec3d scale{1, 1, 1};
  std::optional<Mat4> matrix;
};

struct RigNode {
  std::string name;
  std::optional<std::uint32_t> parent;
  NodeTransform rest;
  std::optional<std::uint32_t> skin;  // of the node's mesh
  std::vector<double> weights;        // at rest; one per morph target of the node's mesh
};

struct RigSkin {
  std::vector<std::uint32_t> joints;  // the node of each joint; at least one joint
  std::vector<Mat4> inverse_bind;     // one per joint
};

// The joints that a vertex follows, as indices into RigSkin::joints. The heaviest comes first. Entries
// without weight come last and name joint 0. The weights sum up to 1.
constexpr std::size_t kJointsOfVertex = 8;
struct VertexJoints {
  std::array<std::uint16_t, kJointsOfVertex> joints{};
  std::array<float, kJointsOfVertex> weights{};
  bool operator==(const VertexJoints&) const = default;
};
// Returns eight pairs of joint and weight in that form. Weights must not be negative. If all are 0, the
// vertex follows joint 0.
VertexJoints normalized(VertexJoints joints);

// What deforms Model::primitives[i]. Both lists are empty for a rigid primitive.
struct RigPrimitive {
  std::vector<VertexJoints> joints;         // one per vertex; empty: not skinned
  std::vector<std::vector<Vec3f>> targets;  // per morph target: the displacement of every vertex; empty: none
};

enum class Interpolation { linear, step, cubic_spline };

// A value over time. Linear rotations are interpolated on the sphere, along the shorter arc.
struct AnimationCurve {
  Interpolation interpolation = Interpolation::linear;
  std::uint32_t width = 0;   // numbers per value: 3, 4, or the number of morph targets
  std::vector<float> times;  // seconds, >= 0, increasing; at least one
  std::vector<float>
      values;  // width numbers per time; 3 * width for cubic splines: in-tangent, value, out-tangent
};

enum class AnimatedPath { translation, rotation, scale, weights };

struct AnimationChannel {
  std::uint32_t node = 0;
  AnimatedPath path = AnimatedPath::translation;
  std::uint32_t curve = 0;  // index into Rig::curves
};

struct RigAnimation {
  std::string name;  // as in Model::animation_names
  std::vector<AnimationChannel> channels;
};

struct Rig {
  std::vector<RigNode> nodes;  // in file order; without cycles
  std::vector<RigSkin> skins;
  std::vector<RigPrimitive> primitives;       // one per Model::primitives
  std::vector<std::uint32_t> instance_nodes;  // node of each Model::instances; empty without nodes
  std::vector<AnimationCurve> curves;
  std::vector<RigAnimation> animations;
};

// Reads everything that moves `model`. For formats other than glTF all primitives are rigid, and nothing else
// is set. Leaves out channels that move no node (KHR_animation_pointer), morph weights of nodes without morph
// targets, and joints of a vertex beyond the eighth. Throws Error{bad_input} that names the file and the
// place, and Error{bad_argument} if a primitive that deforms was split after it was read.
Rig read_rig(const Model& model, const ReadOptions& options = {});

}  // namespace pellucid
