// A model's parts, shapes and clips put together: see posable_data.h.
#include <algorithm>
#include <limits>

#include "scene/posable_data.h"

namespace pellucid {
namespace {

constexpr std::uint64_t kMostElements = std::uint64_t{1} << 28U;
constexpr double kSameTime = 1e-5;  // seconds; float32 times of exporters differ by less
constexpr std::uint32_t kNoShape = std::numeric_limits<std::uint32_t>::max();

// What the scene draws: a primitive, and the instance that draws it.
struct Drawn {
  std::uint32_t primitive = 0;
  std::optional<std::uint32_t> instance;
};

std::vector<Drawn> drawn_primitives(const Model& model) {
  std::vector<Drawn> drawn;
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const std::uint32_t primitive = model.instances[i].primitive;
    if (model.primitives[primitive].triangles) drawn.push_back({primitive, i});
  }
  for (std::uint32_t p = 0; model.instances.empty() && p < model.primitives.size(); ++p) {
    if (model.primitives[p].triangles) drawn.push_back({p, std::nullopt});
  }
  return drawn;
}

// A few bytes of a file may draw a primitive a million times: counts come before memory.
void refuse_absurd_counts(const Model& model, const std::vector<Drawn>& drawn, std::uint32_t subdivisions) {
  std::uint64_t triangles = 0, vertices = 0;
  for (const Drawn& part : drawn) {
    const Mesh& mesh = model.primitives[part.primitive].mesh;
    triangles += std::uint64_t{mesh.triangles.size()} << (2 * std::min(subdivisions, 4U));
    vertices += mesh.positions.size();
  }
  if (triangles <= kMostElements && vertices <= kMostElements) return;
  throw Error(ErrorKind::bad_argument, model.path + ": its scene draws " + std::to_string(triangles) +
                                           " triangles with " + std::to_string(vertices) +
                                           " vertices; the limit is " + std::to_string(kMostElements));
}

std::vector<double> merged_times(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  std::vector<double> merged;
  for (const double time : times) {
    if (merged.empty() || time - merged.back() >= kSameTime) merged.push_back(time);
  }
  return merged;
}

class Builder {
 public:
  Builder(const Model& model, std::uint32_t subdivisions) : model_(model), subdivisions_(subdivisions) {}

  PosableData build() {
    const std::vector<Drawn> drawn = drawn_primitives(model_);
    refuse_absurd_counts(model_, drawn, subdivisions_);
    data_.rig = read_rig(model_);
    shape_of_.assign(model_.primitives.size(), kNoShape);
    for (const Drawn& part : drawn) add_part(part);
    data_.rig.primitives.clear();
    data_.skeleton.emplace(data_.rig.nodes, used_nodes());
    const std::vector<Affine> worlds = data_.skeleton->worlds_at({}, data_.rig.curves, 0);
    for (std::size_t p = 0; p < data_.parts.size(); ++p) place_part(p, worlds);
    for (std::uint32_t i = 0; i < data_.rig.animations.size(); ++i) add_clip(i);
    return std::move(data_);
  }

 private:
  void add_part(const Drawn& drawn) {
    const Primitive& primitive = model_.primitives[drawn.primitive];
    PartMotion motion;
    motion.shape = find_shape(drawn.primitive);
    if (drawn.instance) {
      motion.fixed_world = to_affine(model_.instances[*drawn.instance].world);
      if (!data_.rig.instance_nodes.empty()) motion.node = data_.rig.instance_nodes[*drawn.instance];
    }
    // A skin without joints at the vertices has nothing to hold on to; the node's transform remains.
    if (motion.node && !data_.shapes[motion.shape].joints.empty()) {
      motion.skin = data_.rig.nodes[*motion.node].skin;
    }
    if (motion.node && !data_.shapes[motion.shape].deformation.targets.empty()) {
      morphing_parts_.emplace(*motion.node, static_cast<std::uint32_t>(data_.parts.size()));
    }
    data_.part_motions.push_back(motion);
    ModelPart part;
    part.name = primitive.name;
    part.primitive = drawn.primitive;
    part.instance = drawn.instance.value_or(0);
    part.double_sided = primitive.double_sided;
    data_.parts.push_back(std::move(part));
  }

  std::uint32_t find_shape(std::uint32_t primitive) {
    std::uint32_t& shape = shape_of_[primitive];
    if (shape != kNoShape) return shape;
    shape = static_cast<std::uint32_t>(data_.shapes.size());
    data_.shapes.push_back(make_shape(model_.primitives[primitive].mesh,
                                      std::move(data_.rig.primitives[primitive]), subdivisions_));
    return shape;
  }

  // Those whose world matrices are asked for.
  [[nodiscard]] std::vector<std::uint32_t> used_nodes() const {
    std::vector<std::uint32_t> used;
    for (const PartMotion& part : data_.part_motions) {
      if (part.skin) {
        const std::vector<std::uint32_t>& joints = data_.rig.skins[*part.skin].joints;
        for (const std::uint16_t joint : data_.shapes[part.shape].joints) used.push_back(joints[joint]);
      } else if (part.node) {
        used.push_back(*part.node);
      }
    }
    return used;
  }

  void place_part(std::size_t index, const std::vector<Affine>& worlds) {
    const PartMotion& motion = data_.part_motions[index];
    const Shape& shape = data_.shapes[motion.shape];
    const auto first_vertex = static_cast<std::uint32_t>(data_.vertices);
    data_.parts[index].first_triangle = static_cast<std::uint32_t>(data_.triangles.size());
    data_.parts[index].first_vertex = first_vertex;
    const bool mirrored = data_.is_mirrored(motion, worlds);
    for (Triangle t : shape.triangles) {
      if (mirrored) std::swap(t[1], t[2]);
      data_.triangles.push_back({t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex});
    }
    data_.vertices += shape.positions.size();
  }

  void add_clip(std::uint32_t index) {
    const RigAnimation& animation = data_.rig.animations[index];
    ClipMotion motion{data_.skeleton->motions_of(animation), {}};
    std::vector<double> times;
    for (const AnimationChannel& channel : animation.channels) {
      const bool morphs = channel.path == AnimatedPath::weights;
      const bool moves = morphs ? add_weights(channel, motion) : data_.skeleton->moves(channel.node);
      const std::vector<float>& key_times = data_.rig.curves[channel.curve].times;
      if (moves) times.insert(times.end(), key_times.begin(), key_times.end());
    }
    if (times.empty()) return;
    data_.clips.push_back({animation.name, index, merged_times(std::move(times))});
    data_.clip_motions.push_back(std::move(motion));
  }

  // True if some part has morph targets and is drawn by the channel's node.
  bool add_weights(const AnimationChannel& channel, ClipMotion& motion) const {
    const auto [begin, end] = morphing_parts_.equal_range(channel.node);
    for (auto part = begin; part != end; ++part) motion.weights[part->second] = channel.curve;
    return begin != end;
  }

  const Model& model_;
  std::uint32_t subdivisions_;
  PosableData data_;
  std::vector<std::uint32_t> shape_of_;                         // every primitive's
  std::multimap<std::uint32_t, std::uint32_t> morphing_parts_;  // node -> part with morph targets
};

}  // namespace

PosableData make_posable(const Model& model, std::uint32_t subdivisions) {
  return Builder(model, subdivisions).build();
}

}  // namespace pellucid
