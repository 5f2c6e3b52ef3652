// Implements PosableModel of pellucid/scene.h. A model becomes shapes (primitives, subdivided on request),
// parts that draw the shapes, and clips that move the parts. A pose applies morph targets first, and then
// skins or node matrices.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "pellucid/animation.h"
#include "pellucid/scene.h"
#include "pellucid/subdivide.h"
#include "scene/skeleton.h"

namespace pellucid {

// ---------------------------------------------------------------------------------------------------- shapes

// A primitive in the form in which it is posed.
struct PosedShape {
  std::vector<Triangle> triangles;
  std::vector<Vec3f> positions;
  RigPrimitive deformation;           // of these vertices
  std::vector<std::uint16_t> joints;  // joints of a skin that some vertex follows, increasing
};

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// The largest number of different vertices at one place. Further ones are not welded.
constexpr int kMostVariants = 8;
// The sum of differences of joint weights that quantisation may cause at the two sides of a seam.
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
  // Joints that both vertices follow are counted twice.
  return difference <= 2 * kSameWeights;
}

bool move_alike(const RigPrimitive& deformation, std::uint32_t a, std::uint32_t b) {
  if (!deformation.joints.empty() && !follow_the_same(deformation.joints[a], deformation.joints[b]))
    return false;
  return std::all_of(deformation.targets.begin(), deformation.targets.end(),
                     [&](const auto& target) { return target.empty() || target[a] == target[b]; });
}

// Returns for every vertex the first one at the same place that moves in the same way. Surfaces that touch at
// rest but move apart are not welded.
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

// Returns the heaviest of all joints that the control vertices of a refined vertex follow.
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

PosedShape refined_shape(const Mesh& mesh, const RigPrimitive& deformation, std::uint32_t subdivisions) {
  Subdivision subdivision = subdivide_loop(mesh.triangles, weld_alike(mesh, deformation), subdivisions);
  PosedShape shape;
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

// Makes the shape of a primitive. Without subdivision everything is as in the file. With subdivision,
// vertices are welded first, where position, joints and morph targets agree.
PosedShape make_shape(const Mesh& mesh, RigPrimitive deformation, std::uint32_t subdivisions) {
  PosedShape shape = subdivisions == 0
                         ? PosedShape{mesh.triangles, mesh.positions, std::move(deformation), {}}
                         : refined_shape(mesh, deformation, subdivisions);
  shape.joints = followed_joints(shape.deformation.joints);
  return shape;
}

}  // namespace

// --------------------------------------------------------------------------------------------------- posing

// What moves the vertices of a part.
struct PartMotion {
  std::uint32_t shape = 0;
  std::optional<std::uint32_t> node;  // none: the instance stays where it is
  Affine fixed_world, in_node;
  std::optional<std::uint32_t> skin;  // for a part with joints
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

  std::vector<PosedShape> shapes;
  std::vector<PartMotion> part_motions;  // one per part
  std::vector<ClipMotion> clip_motions;  // one per clip
  ClipMotion rest;
  Rig rig;  // its primitives have been moved into `shapes`
  std::optional<Skeleton> skeleton;
  std::optional<Vec3d> origin;

  // Writes the positions of all vertices at `time` (seconds) of the clip.
  void pose(const ClipMotion& clip, double time, std::vector<Vec3f>& positions) const;
  // Returns whether a part is mirrored if the nodes have these world matrices.
  [[nodiscard]] bool is_mirrored(const PartMotion& part, const std::vector<Affine>& worlds) const;
  // See PosableModel::anchor().
  [[nodiscard]] Vec3d anchor() const;

 private:
  // Returns the matrix that places a part without a skin.
  [[nodiscard]] Affine world_of(const PartMotion& part, const std::vector<Affine>& worlds) const;
  // Makes a matrix lead to positions that are relative to the origin. The difference is rounded to float32,
  // so that it does not depend on how far from the world's origin both are.
  void make_relative(Affine& matrix) const;
  // Returns the matrices of the joints of the skin that the part follows.
  [[nodiscard]] std::vector<Affine> palette_of(const PartMotion& part,
                                               const std::vector<Affine>& worlds) const;
  // Returns the vertices moved by morph targets, which are stored in `storage` if there are any.
  std::span<const Vec3f> morphed(const PartMotion& part, std::uint32_t weights_curve, double time,
                                 std::vector<Vec3f>& storage) const;
};

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

Affine PosableData::world_of(const PartMotion& part, const std::vector<Affine>& worlds) const {
  return part.node ? worlds[skeleton->slot_of(*part.node)] * part.in_node : part.fixed_world;
}

void PosableData::make_relative(Affine& matrix) const {
  if (origin) matrix.origin = to_double(to_float(matrix.origin - *origin));
}

Vec3d PosableData::anchor() const {
  if (part_motions.empty()) return {};
  const PartMotion& part = part_motions.front();
  const std::vector<Affine> worlds = skeleton->worlds_at(rest.nodes, rig.curves, 0);
  if (!part.skin) return world_of(part, worlds).origin;
  const std::vector<std::uint16_t>& joints = shapes[part.shape].joints;
  if (joints.empty()) return {};
  return worlds[skeleton->slot_of(rig.skins[*part.skin].joints[joints.front()])].origin;
}

bool PosableData::is_mirrored(const PartMotion& part, const std::vector<Affine>& worlds) const {
  if (!part.skin) return world_of(part, worlds).mirrors();
  // The majority of the vertices decides, each by its heaviest joint.
  const std::vector<Affine> palette = palette_of(part, worlds);
  const std::vector<VertexJoints>& voters = shapes[part.shape].deformation.joints;
  const auto votes = std::count_if(voters.begin(), voters.end(), [&](const VertexJoints& vertex) {
    return palette[vertex.joints[0]].mirrors();
  });
  return 2 * static_cast<std::size_t>(votes) > voters.size();
}

std::span<const Vec3f> PosableData::morphed(const PartMotion& part, std::uint32_t weights_curve, double time,
                                            std::vector<Vec3f>& storage) const {
  const PosedShape& shape = shapes[part.shape];
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
      std::vector<Affine> palette = palette_of(part, worlds);
      // Weights have the sum 1, so all joints may be moved by the same vector.
      for (Affine& joint : palette) make_relative(joint);
      const std::vector<VertexJoints>& joints = shapes[part.shape].deformation.joints;
      for (std::size_t v = 0; v < source.size(); ++v) {
        target[v] = to_float(skinned(to_double(source[v]), joints[v], palette));
      }
    } else {
      Affine world = world_of(part, worlds);
      make_relative(world);
      for (std::size_t v = 0; v < source.size(); ++v) {
        target[v] = to_float(world.point(to_double(source[v])));
      }
    }
  }
}

// ------------------------------------------------------------------------------- from a model to its parts

namespace {

constexpr std::uint64_t kMostElements = std::uint64_t{1} << 28U;
constexpr double kSameTime = 1e-5;  // seconds; float32 times of exporters differ by less
constexpr std::uint32_t kNoShape = std::numeric_limits<std::uint32_t>::max();

// A primitive that the scene draws, and the instance that draws it.
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

// Throws if the parts have too many triangles or vertices. A few bytes of a file may draw a primitive a
// million times, so this is checked before memory is allocated.
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

class PosableBuilder {
 public:
  PosableBuilder(const Model& model, std::uint32_t subdivisions, const std::optional<Vec3d>& origin)
      : model_(model), subdivisions_(subdivisions) {
    data_.origin = origin;
  }

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
      motion.in_node = to_affine(model_.instances[*drawn.instance].in_node);
      if (!data_.rig.instance_nodes.empty()) motion.node = data_.rig.instance_nodes[*drawn.instance];
    }
    // A skin has no effect on vertices without joints. Then the transform of the node applies.
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
    part.skinned = motion.skin.has_value();
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

  // Returns the nodes whose world matrices are needed.
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
    const PosedShape& shape = data_.shapes[motion.shape];
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

  // Records the weights of a channel. Returns whether the node of the channel draws a part with morph
  // targets.
  bool add_weights(const AnimationChannel& channel, ClipMotion& motion) const {
    const auto [begin, end] = morphing_parts_.equal_range(channel.node);
    for (auto part = begin; part != end; ++part) motion.weights[part->second] = channel.curve;
    return begin != end;
  }

  const Model& model_;
  std::uint32_t subdivisions_;
  PosableData data_;
  std::vector<std::uint32_t> shape_of_;                         // by primitive
  std::multimap<std::uint32_t, std::uint32_t> morphing_parts_;  // node -> part with morph targets
};

}  // namespace

// ----------------------------------------------------------------------------------------- public functions

namespace {

constexpr double kMostTimes = 1e6;
// In steps. If rounding lets the last step fall short of the last key time by less than this, no further time
// is added.
constexpr double kRounding = 1e-6;

}  // namespace

std::vector<double> times_at_rate(const AnimationClip& clip, double rate) {
  if (!(rate > 0) || !std::isfinite(rate)) {
    throw Error(ErrorKind::bad_argument, "a rate of key frames must be positive");
  }
  if (clip.key_times.empty()) return {};
  const double first = clip.key_times.front(), last = clip.key_times.back();
  const double steps = std::ceil((last - first) * rate - kRounding);
  if (steps > kMostTimes) {
    throw Error(ErrorKind::bad_argument, clip.name + ": " + std::to_string(rate) +
                                             " key frames a second are more than a million in all");
  }
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(steps) + 1);
  for (int step = 0; step < steps; ++step) times.push_back(first + step / rate);
  times.push_back(last);
  return times;
}

PosableModel::PosableModel(const Model& model, std::uint32_t subdivisions, const std::optional<Vec3d>& origin)
    : data_(std::make_shared<const PosableData>(PosableBuilder(model, subdivisions, origin).build())) {}

const std::vector<Triangle>& PosableModel::triangles() const {
  return data_->triangles;
}

const std::vector<ModelPart>& PosableModel::parts() const {
  return data_->parts;
}

const std::vector<AnimationClip>& PosableModel::clips() const {
  return data_->clips;
}

std::vector<Vec3f> PosableModel::rest_pose() const {
  std::vector<Vec3f> positions;
  data_->pose(data_->rest, 0, positions);
  return positions;
}

Vec3d PosableModel::anchor() const {
  return data_->anchor();
}

void PosableModel::pose(std::uint32_t clip, double time, std::vector<Vec3f>& positions) const {
  if (clip >= data_->clips.size()) {
    throw Error(ErrorKind::bad_argument, "clip " + std::to_string(clip) + " does not exist; there are " +
                                             std::to_string(data_->clips.size()));
  }
  data_->pose(data_->clip_motions[clip], time, positions);
}

}  // namespace pellucid
