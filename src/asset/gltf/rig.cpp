// Implements pellucid/animation.h: reads nodes, skins, joints, morph targets and animations of a glTF model.
// Format: glTF 2.0, sections 3.5, 3.7 and 3.11, and appendix C.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "asset/gltf/accessors.h"
#include "asset/gltf/scene.h"
#include "pellucid/animation.h"

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
  const std::vector<float> weights = accessors.read_reals(weights_accessor, "VEC4");
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

// Reads joints, weights and morph targets of the primitive `fields`, which has `vertices` vertices.
RigPrimitive read_deformation(const Fields& fields, std::uint64_t vertices, AccessorReader& accessors) {
  RigPrimitive primitive;
  primitive.joints = read_joints(fields, vertices, accessors);
  for (std::uint64_t t = 0; t < fields.size("targets"); ++t) {
    primitive.targets.push_back(read_target(fields, t, vertices, accessors));
  }
  return primitive;
}

// How the values of an animated path are stored in an accessor.
struct ValueForm {
  const char* type;
  std::uint32_t width;              // numbers per value
  std::uint32_t elements_of_value;  // elements of the accessor per value
};

std::optional<AnimatedPath> path_of(const std::string& name) {
  if (name == "translation") return AnimatedPath::translation;
  if (name == "rotation") return AnimatedPath::rotation;
  if (name == "scale") return AnimatedPath::scale;
  if (name == "weights") return AnimatedPath::weights;
  return std::nullopt;
}

ValueForm form_of(AnimatedPath path, const RigNode& node) {
  const auto targets = static_cast<std::uint32_t>(node.weights.size());
  if (path == AnimatedPath::weights) return {"SCALAR", targets, targets};
  if (path == AnimatedPath::rotation) return {"VEC4", 4, 1};
  return {"VEC3", 3, 1};
}

Interpolation interpolation_of(const Fields& sampler) {
  const std::string name = sampler.text_or("interpolation", "LINEAR");
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  sampler.fail("interpolation " + name.substr(0, 20) + " does not exist");
}

class AnimationReader {
 public:
  AnimationReader(const Fields& root, AccessorReader& accessors, Rig& rig)
      : root_(root), accessors_(accessors), rig_(rig) {}

  void read() {
    for (std::uint64_t i = 0; i < root_.size("animations"); ++i) {
      const Fields fields = root_.element("animations", i);
      RigAnimation animation;
      animation.name = short_name(fields.text_or("name", "animation " + std::to_string(i)));
      for (std::uint64_t c = 0; c < fields.size("channels"); ++c) read_channel(fields, c, animation);
      rig_.animations.push_back(std::move(animation));
    }
  }

 private:
  void read_channel(const Fields& animation, std::uint64_t index, RigAnimation& result) {
    const Fields channel = animation.element("channels", index);
    const Fields target = channel.object("target");
    const auto path = path_of(target.text("path"));
    const auto node = target.find_index("node");
    if (!path || !node) return;
    if (*node >= rig_.nodes.size()) target.fail("node " + std::to_string(*node) + " does not exist");
    const RigNode& moved = rig_.nodes[*node];
    if (*path == AnimatedPath::weights && moved.weights.empty()) return;
    if (*path != AnimatedPath::weights && moved.rest.matrix) {
      target.fail("node " + std::to_string(*node) + " has a matrix, which cannot be animated");
    }
    const Fields sampler = animation.element("samplers", channel.index("sampler"));
    result.channels.push_back(
        {static_cast<std::uint32_t>(*node), *path, find_curve(sampler, form_of(*path, moved))});
  }

  // Returns the curve of a sampler. Samplers of all animations may share accessors, so each pair of accessors
  // is read once.
  std::uint32_t find_curve(const Fields& sampler, const ValueForm& form) {
    const Interpolation interpolation = interpolation_of(sampler);
    const std::uint64_t input = sampler.index("input");
    const std::uint64_t output = sampler.index("output");
    const Key key{input, output, interpolation, form.width, form.elements_of_value};
    if (const auto known = curves_.find(key); known != curves_.end()) return known->second;
    AnimationCurve curve;
    curve.interpolation = interpolation;
    curve.width = form.width;
    curve.times = read_times(input);
    curve.values = read_values(sampler, output, form, curve);
    const auto index = static_cast<std::uint32_t>(rig_.curves.size());
    rig_.curves.push_back(std::move(curve));
    curves_.emplace(key, index);
    return index;
  }

  std::vector<float> read_times(std::uint64_t accessor) {
    const Fields fields = accessors_.accessor(accessor);
    if (fields.index("componentType") != single_float) fields.fail("times of key frames are not floats");
    std::vector<float> times = accessors_.read_reals(accessor, "SCALAR");
    if (times.empty()) fields.fail("the animation has no key frames");
    for (std::size_t i = 0; i < times.size(); ++i) {
      const bool later = i == 0 ? times[i] >= 0 : times[i] > times[i - 1];
      if (!later || !std::isfinite(times[i])) {
        fields.fail("time " + std::to_string(i) + " is negative, not finite, or not later than that before");
      }
    }
    return times;
  }

  std::vector<float> read_values(const Fields& sampler, std::uint64_t accessor, const ValueForm& form,
                                 const AnimationCurve& curve) {
    const std::uint64_t values = curve.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const std::uint64_t expected = values * curve.times.size() * form.elements_of_value;
    const std::uint64_t count = accessors_.count(accessor);
    if (count != expected) {
      sampler.fail("its output has " + std::to_string(count) + " elements; " +
                   std::to_string(curve.times.size()) + " key frames need " + std::to_string(expected));
    }
    std::vector<float> result = accessors_.read_reals(accessor, form.type);
    if (const auto at = find_non_finite(result); at >= 0) {
      accessors_.accessor(accessor).fail("number " + std::to_string(at) + " of it is not finite");
    }
    return result;
  }

  using Key = std::tuple<std::uint64_t, std::uint64_t, Interpolation, std::uint32_t, std::uint32_t>;

  const Fields& root_;
  AccessorReader& accessors_;
  Rig& rig_;
  std::map<Key, std::uint32_t> curves_;
};

class RigReader {
 public:
  RigReader(const Model& model, const ReadOptions& options)
      : model_(model),
        root_(model.document->path, model.document->json, ""),
        accessors_(*model.document, options) {}

  Rig read() {
    read_instances();  // Refuses cycles first.
    read_skins();
    read_nodes();
    read_primitives();
    check_joints();
    AnimationReader(root_, accessors_, rig_).read();
    return std::move(rig_);
  }

 private:
  void read_instances() {
    const std::uint64_t nodes = root_.size("nodes");
    for (const Instance& instance : model_.instances) {
      if (instance.node >= nodes)
        throw Error(ErrorKind::bad_argument, model_.path + ": its instances are not those of the file");
      rig_.instance_nodes.push_back(instance.node);
    }
  }

  void read_nodes() {
    const std::uint64_t count = root_.size("nodes");
    rig_.nodes.resize(count);
    for (std::uint64_t i = 0; i < count; ++i) {
      const Fields fields = root_.element("nodes", i);
      RigNode& node = rig_.nodes[i];
      node.name = short_name(fields.text_or("name", ""));
      node.rest = read_transform(fields);
      for (std::uint64_t k = 0; k < fields.size("children"); ++k) {
        rig_.nodes[fields.element_index("children", k)].parent = static_cast<std::uint32_t>(i);
      }
      const auto mesh = fields.find_index("mesh");
      if (!mesh) continue;
      node.weights = read_weights(fields, root_.element("meshes", *mesh));
      if (const auto skin = fields.find_index("skin")) {
        if (*skin >= rig_.skins.size()) fields.fail("skin " + std::to_string(*skin) + " does not exist");
        node.skin = static_cast<std::uint32_t>(*skin);
      }
    }
  }

  static NodeTransform read_transform(const Fields& node) {
    NodeTransform transform;
    const auto matrix = node.numbers("matrix", 16);
    const auto translation = node.numbers("translation", 3);
    const auto rotation = node.numbers("rotation", 4);
    const auto scale = node.numbers("scale", 3);
    if (!matrix.empty()) {
      std::copy(matrix.begin(), matrix.end(), transform.matrix.emplace().m.begin());
      return transform;
    }
    if (!translation.empty()) transform.translation = {translation[0], translation[1], translation[2]};
    if (!rotation.empty()) std::copy(rotation.begin(), rotation.end(), transform.rotation.begin());
    if (!scale.empty()) transform.scale = {scale[0], scale[1], scale[2]};
    return transform;
  }

  // Returns the weights of a node or, where it has none, of its mesh. All primitives of a mesh have the same
  // number of morph targets.
  static std::vector<double> read_weights(const Fields& node, const Fields& mesh) {
    const std::uint64_t primitives = mesh.size("primitives");
    const std::uint64_t targets = primitives == 0 ? 0 : mesh.element("primitives", 0).size("targets");
    for (std::uint64_t p = 1; p < primitives; ++p) {
      if (mesh.element("primitives", p).size("targets") != targets)
        mesh.fail("its primitives have different numbers of morph targets");
    }
    for (const Fields& fields : {node, mesh}) {
      if (fields.has("weights")) return fields.numbers("weights", targets);
    }
    return std::vector<double>(targets, 0.0);
  }

  void read_skins() {
    for (std::uint64_t s = 0; s < root_.size("skins"); ++s) {
      const Fields fields = root_.element("skins", s);
      RigSkin skin;
      for (std::uint64_t k = 0; k < fields.size("joints"); ++k) {
        const std::uint64_t joint = fields.element_index("joints", k);
        if (joint >= root_.size("nodes")) fields.fail("joint " + std::to_string(joint) + " does not exist");
        skin.joints.push_back(static_cast<std::uint32_t>(joint));
      }
      if (skin.joints.empty()) fields.fail("it has no joints");
      skin.inverse_bind = read_inverse_bind(fields, skin.joints.size());
      rig_.skins.push_back(std::move(skin));
    }
  }

  std::vector<Mat4> read_inverse_bind(const Fields& skin, std::size_t joints) {
    std::vector<Mat4> matrices(joints);
    const auto accessor = skin.find_index("inverseBindMatrices");
    if (!accessor) return matrices;
    const std::uint64_t count = accessors_.count(*accessor);
    if (count < joints) {
      skin.fail("it has " + std::to_string(count) + " inverse bind matrices for " + std::to_string(joints) +
                " joints");
    }
    const std::vector<float> numbers = accessors_.read_reals(*accessor, "MAT4");
    for (std::size_t k = 0; k < joints; ++k) {
      for (std::size_t i = 0; i < 16; ++i) matrices[k].m[i] = numbers[16 * k + i];
    }
    if (const auto at = find_non_finite(numbers); at >= 0) {
      accessors_.accessor(*accessor).fail("matrix " + std::to_string(at / 16) + " is not finite");
    }
    return matrices;
  }

  void read_primitives() {
    for (const Primitive& primitive : model_.primitives) {
      RigPrimitive& result = rig_.primitives.emplace_back();
      if (!primitive.triangles) continue;
      const Fields mesh = root_.element("meshes", primitive.mesh_index);
      const Fields fields = mesh.element("primitives", primitive.primitive_index);
      const bool deforms = fields.size("targets") > 0 || fields.object("attributes").has("JOINTS_0");
      if (deforms && primitive.new_vertices) {
        throw Error(ErrorKind::bad_argument, model_.path + ": " + primitive.name +
                                                 " deforms and was split; read its rig before splitting");
      }
      if (!primitive.new_vertices) {
        result = read_deformation(fields, primitive.mesh.positions.size(), accessors_);
      }
    }
  }

  // Checks joint indices. The number of joints is known only after a node combines a mesh with a skin.
  void check_joints() const {
    std::vector<std::uint64_t> most(rig_.primitives.size(), 0);
    for (std::size_t p = 0; p < most.size(); ++p) {
      for (const VertexJoints& vertex : rig_.primitives[p].joints) {
        most[p] =
            std::max<std::uint64_t>(most[p], *std::max_element(vertex.joints.begin(), vertex.joints.end()));
      }
    }
    for (std::size_t i = 0; i < model_.instances.size(); ++i) {
      const std::uint32_t node = rig_.instance_nodes[i];
      const std::uint32_t primitive = model_.instances[i].primitive;
      if (!rig_.nodes[node].skin) continue;
      const std::uint32_t skin = *rig_.nodes[node].skin;
      if (rig_.primitives[primitive].joints.empty() || most[primitive] < rig_.skins[skin].joints.size())
        continue;
      root_.element("nodes", node)
          .fail("its mesh follows joint " + std::to_string(most[primitive]) + ", but skins[" +
                std::to_string(skin) + "] has " + std::to_string(rig_.skins[skin].joints.size()) + " joints");
    }
  }

  const Model& model_;
  Fields root_;
  AccessorReader accessors_;
  Rig rig_;
};

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
    // Exporters may leave any number as the joint of an entry without weight.
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

Rig read_rig(const Model& model, const ReadOptions& options) {
  if (model.document != nullptr) return RigReader(model, options).read();
  Rig rig;
  rig.primitives.resize(model.primitives.size());
  return rig;
}

}  // namespace pellucid
