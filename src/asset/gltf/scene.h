// Internal to the module `asset`: walks the node hierarchy of a glTF scene. In: the JSON of a document. Out:
// every node that is drawn, with its world matrix. Format: glTF 2.0, section 3.5.
#pragma once

#include <cstdint>
#include <functional>

#include "asset/gltf/json_fields.h"

namespace pellucid {

using NodeVisitor = std::function<void(const Fields& node, std::uint64_t index, const Mat4& world)>;
// Walks the nodes of the default scene, or of all root nodes if the file has no scene, parents before
// children, and calls `visit` for each. Fails for cycles, a node with two parents, and indices out of range.
void for_each_node(const Fields& root, const NodeVisitor& visit);

}  // namespace pellucid
