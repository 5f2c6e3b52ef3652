// What moves a glTF model: see pellucid/animation.h. Format: glTF 2.0, sections 3.5 and 3.7.3.
#include <algorithm>
#include <cmath>

#include "asset/gltf_animation.h"
#include "asset/gltf_deformation.h"
#include "asset/gltf_scene.h"

namespace pellucid {
namespace {

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
    read_animations(root_, accessors_, rig_);
    return std::move(rig_);
  }

 private:
  void read_instances() {
    for_each_node(root_, [&](const Fields& node, std::uint64_t index, const Mat4& /*world*/) {
      const auto mesh = node.find_index("mesh");
      if (!mesh) return;
      const std::uint64_t primitives = root_.element("meshes", *mesh).size("primitives");
      for (std::uint64_t p = 0; p < primitives; ++p) {
        rig_.instance_nodes.push_back(static_cast<std::uint32_t>(index));
      }
    });
    if (rig_.instance_nodes.size() != model_.instances.size()) {
      throw Error(ErrorKind::bad_argument, model_.path + ": its instances are not those of the file");
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

  // All primitives of a mesh have the same morph targets; the node's weights come before the mesh's.
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
    const std::vector<float> numbers = read_reals(*accessor, "MAT4", accessors_);
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

  // Which joints there are is known only where a node brings mesh and skin together.
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

Rig read_rig(const Model& model, const ReadOptions& options) {
  if (model.document != nullptr) return RigReader(model, options).read();
  Rig rig;
  rig.primitives.resize(model.primitives.size());
  return rig;
}

}  // namespace pellucid
