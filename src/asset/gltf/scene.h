// Internal to the module `asset`: walks the node hierarchy of a glTF scene. In: the JSON of a document. Out:
// every node that is drawn, with its world matrix. Format: glTF 2.0, section 3.5.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "asset/gltf/json_fields.h"

namespace pellucid {

struct SceneNode {
  Fields fields;
  std::uint64_t index = 0;
  Mat4 world;           // local to world, at rest
  bool visible = true;  // neither it nor an ancestor is hidden by KHR_node_visibility
};
using NodeVisitor = std::function<void(const SceneNode& node)>;
// Walks the nodes of the default scene, or of all root nodes if the file has no scene, parents before
// children, and calls `visit` for each. Fails for cycles, a node with two parents, and indices out of range.
void for_each_node(const Fields& root, const NodeVisitor& visit);

// Returns a * b for column-major matrices, which applies b first.
Mat4 multiply(const Mat4& a, const Mat4& b);

// Returns the matrix that scales, then rotates by a quaternion (x, y, z, w), then translates.
Mat4 compose(const std::array<double, 3>& translation, const std::array<double, 4>& rotation,
             const std::array<double, 3>& scale);

}  // namespace pellucid
