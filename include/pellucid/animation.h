// pellucid/animation.h - module `asset`: what moves a glTF model: nodes, skins, morph targets, key frames.
//
// In: a model that read_model gave. Out: plain data, read on demand, so that those who order static meshes
// do not pay for it. Posing is the module `scene` (pellucid/scene.h). Format: glTF 2.0, sections 3.5, 3.7 and
// 3.11.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

// Where a node stands relative to its parent: scaled, then rotated (x, y, z, w), then moved; or a matrix in
// place of the three.
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
  std::vector<double> weights;        // at rest, one per morph target of the node's mesh
};

struct RigSkin {
  std::vector<std::uint32_t> joints;  // node of each; at least one
  std::vector<Mat4> inverse_bind;     // as many
};

// The joints that a vertex follows, as indices into RigSkin::joints: heaviest first, those without weight
// last (joint 0). The weights' sum is 1.
constexpr std::size_t kJointsOfVertex = 8;
struct VertexJoints {
  std::array<std::uint16_t, kJointsOfVertex> joints{};
  std::array<float, kJointsOfVertex> weights{};
  bool operator==(const VertexJoints&) const = default;
};
// Any eight pairs in that form. Weights must not be negative; where all are 0 the vertex follows joint 0.
VertexJoints normalized(VertexJoints joints);

// Beside Model::primitives[i]; both empty where the primitive is rigid.
struct RigPrimitive {
  std::vector<VertexJoints> joints;         // one per vertex; empty: not skinned
  std::vector<std::vector<Vec3f>> targets;  // how far each morph target moves each vertex; empty: nowhere
};

enum class Interpolation { linear, step, cubic_spline };

// A value over time. Linear rotations are interpolated on the sphere, along the shorter way.
struct AnimationCurve {
  Interpolation interpolation = Interpolation::linear;
  std::uint32_t width = 0;    // numbers per value: 3, 4, or that of morph targets
  std::vector<float> times;   // seconds, >= 0, increasing; at least one
  std::vector<float> values;  // width numbers per time; cubic splines: in-tangent, value and out-tangent
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
  std::vector<RigNode> nodes;  // as in the file; no cycles
  std::vector<RigSkin> skins;
  std::vector<RigPrimitive> primitives;       // beside Model::primitives
  std::vector<std::uint32_t> instance_nodes;  // node of each Model::instances; empty without nodes
  std::vector<AnimationCurve> curves;
  std::vector<RigAnimation> animations;
};

// Everything that moves `model`. Models of other formats than glTF have nothing but empty primitives.
// Channels that move no node (KHR_animation_pointer) and morph weights of nodes without morph targets are
// left out; more than eight joints a vertex are not read. Throws Error{bad_input} naming the file and the
// place, Error{bad_argument} where a deforming primitive was split since it was read.
Rig read_rig(const Model& model, const ReadOptions& options = {});

}  // namespace pellucid
