// Vertices at a moment: see posable_data.h.
#include <algorithm>

#include "scene/posable_data.h"
#include "scene/sample_curve.h"

namespace pellucid {
namespace {

Vec3d skinned(const Vec3d& position, const VertexJoints& vertex, const std::vector<Affine>& palette) {
  Vec3d sum;
  for (std::size_t k = 0; k < kJointsOfVertex && vertex.weights[k] > 0; ++k) {
    sum += palette[vertex.joints[k]].point(position) * static_cast<double>(vertex.weights[k]);
  }
  return sum;
}

}  // namespace

std::vector<Affine> PosableData::palette_of(const PartMotion& part, const std::vector<Affine>& worlds) const {
  const RigSkin& skin = rig.skins[*part.skin];
  const std::vector<std::uint16_t>& joints = shapes[part.shape].joints;
  std::vector<Affine> palette(joints.empty() ? 0 : joints.back() + std::size_t{1});
  for (const std::uint16_t joint : joints) {
    palette[joint] = worlds[skeleton->slot_of(skin.joints[joint])] * to_affine(skin.inverse_bind[joint]);
  }
  return palette;
}

bool PosableData::is_mirrored(const PartMotion& part, const std::vector<Affine>& worlds) const {
  if (!part.skin) return (part.node ? worlds[skeleton->slot_of(*part.node)] : part.fixed_world).mirrors();
  // Each vertex votes as its heaviest joint does.
  const std::vector<Affine> palette = palette_of(part, worlds);
  const std::vector<VertexJoints>& voters = shapes[part.shape].deformation.joints;
  const auto votes = std::count_if(voters.begin(), voters.end(), [&](const VertexJoints& vertex) {
    return palette[vertex.joints[0]].mirrors();
  });
  return 2 * static_cast<std::size_t>(votes) > voters.size();
}

std::span<const Vec3f> PosableData::morphed(const PartMotion& part, std::uint32_t weights_curve, double time,
                                            std::vector<Vec3f>& storage) const {
  const Shape& shape = shapes[part.shape];
  if (shape.deformation.targets.empty() || !part.node) return shape.positions;
  std::vector<double> weights = rig.nodes[*part.node].weights;
  if (weights_curve != kNoCurve) sample_curve(rig.curves[weights_curve], time, weights);
  storage = shape.positions;
  for (std::size_t t = 0; t < weights.size(); ++t) {
    const std::vector<Vec3f>& target = shape.deformation.targets[t];
    if (target.empty() || weights[t] == 0) continue;
    for (std::size_t v = 0; v < storage.size(); ++v) {
      storage[v] = to_float(to_double(storage[v]) + to_double(target[v]) * weights[t]);
    }
  }
  return storage;
}

void PosableData::pose(const ClipMotion& clip, double time, std::vector<Vec3f>& positions) const {
  const std::vector<Affine> worlds = skeleton->worlds_at(clip.nodes, rig.curves, time);
  positions.resize(vertices);
  std::vector<Vec3f> storage;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const PartMotion& part = part_motions[p];
    const auto weights = clip.weights.find(p);
    const std::uint32_t weights_curve = weights == clip.weights.end() ? kNoCurve : weights->second;
    const std::span<const Vec3f> source = morphed(part, weights_curve, time, storage);
    const std::span<Vec3f> target = std::span(positions).subspan(parts[p].first_vertex, source.size());
    if (part.skin) {
      const std::vector<Affine> palette = palette_of(part, worlds);
      const std::vector<VertexJoints>& joints = shapes[part.shape].deformation.joints;
      for (std::size_t v = 0; v < source.size(); ++v) {
        target[v] = to_float(skinned(to_double(source[v]), joints[v], palette));
      }
    } else {
      const Affine world = part.node ? worlds[skeleton->slot_of(*part.node)] : part.fixed_world;
      for (std::size_t v = 0; v < source.size(); ++v) {
        target[v] = to_float(world.point(to_double(source[v])));
      }
    }
  }
}

}  // namespace pellucid
