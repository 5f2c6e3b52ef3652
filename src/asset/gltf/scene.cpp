// Implements scene.h, and read_cameras() of pellucid/asset.h. Format: glTF 2.0, sections 3.5 and 3.10.
#include "asset/gltf/scene.h"

#include <algorithm>
#include <cmath>

#include "asset/formats/text_cursor.h"
#include "pellucid/asset.h"

namespace pellucid {
namespace {

constexpr std::uint64_t kNoParent = ~std::uint64_t{0};

template <std::size_t N>
std::array<double, N> numbers_or(const Fields& node, const char* key, std::array<double, N> otherwise) {
  const auto numbers = node.numbers(key, N);
  if (!numbers.empty()) std::copy(numbers.begin(), numbers.end(), otherwise.begin());
  return otherwise;
}

Mat4 local_matrix(const Fields& node) {
  const auto matrix = node.numbers("matrix", 16);
  if (matrix.empty()) {
    return compose(numbers_or<3>(node, "translation", {}), numbers_or<4>(node, "rotation", {0, 0, 0, 1}),
                   numbers_or<3>(node, "scale", {1, 1, 1}));
  }
  Mat4 local;
  std::copy(matrix.begin(), matrix.end(), local.m.begin());
  return local;
}

// Returns the parent of every node. Fails if a node has two parents. If each has at most one, no cycle can be
// reached from a root.
std::vector<std::uint64_t> find_parents(const Fields& root) {
  const std::uint64_t count = root.size("nodes");
  std::vector<std::uint64_t> parents(count, kNoParent);
  for (std::uint64_t i = 0; i < count; ++i) {
    const Fields node = root.element("nodes", i);
    for (std::uint64_t k = 0; k < node.size("children"); ++k) {
      const std::uint64_t child = node.element_index("children", k);
      if (child >= count) node.fail("child " + std::to_string(child) + " does not exist");
      if (parents[child] != kNoParent) {
        node.fail("node " + std::to_string(child) + " has two parents, this and nodes[" +
                  std::to_string(parents[child]) + "]");
      }
      parents[child] = i;
    }
  }
  return parents;
}

void refuse_cycles(const Fields& root, const std::vector<std::uint64_t>& parents) {
  // Climb from every node to its root. Nodes that are known to end at a root stop the climb, so each node is
  // visited once.
  enum : std::uint8_t { unknown, climbing, ends_at_root };
  std::vector<std::uint8_t> state(parents.size(), unknown);
  std::vector<std::uint64_t> path;
  for (std::uint64_t start = 0; start < parents.size(); ++start) {
    path.clear();
    for (std::uint64_t node = start; node != kNoParent && state[node] != ends_at_root; node = parents[node]) {
      if (state[node] == climbing) root.element("nodes", node).fail("it is its own ancestor");
      state[node] = climbing;
      path.push_back(node);
    }
    for (const std::uint64_t node : path) state[node] = ends_at_root;
  }
}

std::vector<std::uint64_t> scene_roots(const Fields& root, const std::vector<std::uint64_t>& parents) {
  std::vector<std::uint64_t> roots;
  if (root.size("scenes") == 0) {
    for (std::uint64_t i = 0; i < parents.size(); ++i) {
      if (parents[i] == kNoParent) roots.push_back(i);
    }
    return roots;
  }
  const Fields scene = root.element("scenes", root.index_or("scene", 0));
  std::vector<bool> seen(parents.size(), false);
  for (std::uint64_t k = 0; k < scene.size("nodes"); ++k) {
    const std::uint64_t node = scene.element_index("nodes", k);
    if (node >= parents.size()) scene.fail("node " + std::to_string(node) + " does not exist");
    if (parents[node] != kNoParent) scene.fail("node " + std::to_string(node) + " is not a root node");
    if (seen[node]) scene.fail("node " + std::to_string(node) + " is listed twice");
    seen[node] = true;
    roots.push_back(node);
  }
  return roots;
}

double positive(const Fields& fields, const char* key) {
  const double value = fields.number(key);
  if (!(value > 0) || !std::isfinite(value)) fields.fail(std::string(key) + " is not a positive number");
  return value;
}

ModelCamera read_camera(const Fields& fields) {
  ModelCamera camera;
  camera.name = short_name(fields.text_or("name", ""));
  const std::string type = fields.text("type");
  if (type == "perspective") {
    const Fields lens = fields.object("perspective");
    const double angle = positive(lens, "yfov");
    if (angle > 3.1) lens.fail("yfov is not an angle of view in radians");
    camera.half_height = std::tan(0.5 * angle);
  } else if (type == "orthographic") {
    camera.perspective = false;
    camera.half_height = positive(fields.object("orthographic"), "ymag");
  } else {
    fields.fail("type " + in_quotes(type) + " does not exist");
  }
  return camera;
}

bool is_visible(const Fields& node) {
  const auto extension = node.extension("KHR_node_visibility");
  return !extension || extension->flag_or("visible", true);
}

}  // namespace

Mat4 multiply(const Mat4& a, const Mat4& b) {
  Mat4 product;
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) {
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += a.m[4 * k + row] * b.m[4 * column + k];
      product.m[4 * column + row] = sum;
    }
  }
  return product;
}

Mat4 compose(const std::array<double, 3>& translation, const std::array<double, 4>& rotation,
             const std::array<double, 3>& scale) {
  const auto [x, y, z, w] = rotation;
  Mat4 local;
  local.m = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),     0,
             2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),     0,
             2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y), 0,
             translation[0],          translation[1],          translation[2],          1};
  for (std::size_t column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 3; ++row) local.m[4 * column + row] *= scale[column];
  }
  return local;
}

void for_each_node(const Fields& root, const NodeVisitor& visit) {
  const std::vector<std::uint64_t> parents = find_parents(root);
  refuse_cycles(root, parents);

  // Depth first and without recursion, because hierarchies may be a million nodes deep.
  struct Visit {
    std::uint64_t node;
    Mat4 parent_world;
    bool parent_visible;
  };
  std::vector<Visit> pending;
  const std::vector<std::uint64_t> roots = scene_roots(root, parents);
  for (auto node = roots.rbegin(); node != roots.rend(); ++node) pending.push_back({*node, Mat4{}, true});
  while (!pending.empty()) {
    const Visit next = pending.back();
    pending.pop_back();
    const Fields node = root.element("nodes", next.node);
    const Mat4 world = multiply(next.parent_world, local_matrix(node));
    const bool visible = next.parent_visible && is_visible(node);
    visit({node, next.node, world, visible});
    for (std::uint64_t k = node.size("children"); k-- > 0;) {
      pending.push_back({node.element_index("children", k), world, visible});
    }
  }
}

std::vector<ModelCamera> read_cameras(const Model& model) {
  std::vector<ModelCamera> cameras;
  if (model.document == nullptr) return cameras;
  const Fields root(model.document->path, model.document->json, "");
  for_each_node(root, [&](const SceneNode& node) {
    const auto index = node.fields.find_index("camera");
    if (!index) return;
    ModelCamera camera = read_camera(root.element("cameras", *index));
    if (camera.name.empty()) camera.name = short_name(node.fields.text_or("name", ""));
    camera.world = node.world;
    cameras.push_back(std::move(camera));
  });
  return cameras;
}

}  // namespace pellucid
