// Internal to the module `scene`: what a PosableModel holds.
#pragma once

#include <map>
#include <optional>
#include <span>

#include "pellucid/scene.h"
#include "scene/shape.h"
#include "scene/skeleton.h"

namespace pellucid {

// What moves a part's vertices.
struct PartMotion {
  std::uint32_t shape = 0;
  std::optional<std::uint32_t> node;  // none: the instance stays where it is
  Affine fixed_world;
  std::optional<std::uint32_t> skin;  // of a part with joints
};

struct ClipMotion {
  std::vector<NodeMotion> nodes;
  std::map<std::uint32_t, std::uint32_t> weights;  // part -> curve of its morph weights
};

struct PosableData {
  std::vector<Triangle> triangles;
  std::vector<ModelPart> parts;
  std::vector<AnimationClip> clips;
  std::size_t vertices = 0;  // of all parts

  std::vector<Shape> shapes;
  std::vector<PartMotion> part_motions;  // beside parts
  std::vector<ClipMotion> clip_motions;  // beside clips
  ClipMotion rest;
  Rig rig;  // its primitives have become shapes
  std::optional<Skeleton> skeleton;

  void pose(const ClipMotion& clip, double time, std::vector<Vec3f>& positions) const;
  // Is a part mirrored where its nodes stand like that?
  [[nodiscard]] bool is_mirrored(const PartMotion& part, const std::vector<Affine>& worlds) const;

 private:
  // Matrices of the skin's joints, where a part follows them.
  [[nodiscard]] std::vector<Affine> palette_of(const PartMotion& part,
                                               const std::vector<Affine>& worlds) const;
  // Vertices moved by morph targets; `storage` holds them where there are some.
  std::span<const Vec3f> morphed(const PartMotion& part, std::uint32_t weights_curve, double time,
                                 std::vector<Vec3f>& storage) const;
};

PosableData make_posable(const Model& model, std::uint32_t subdivisions);

}  // namespace pellucid
