// Internal to the module `asset`: the nodes of a glTF scene become instances.
#pragma once

#include <functional>

#include "asset/json_fields.h"

namespace pellucid {

// Walk the nodes of the default scene (of all root nodes where the file has no scene), parents before
// children, and call `visit(node, index, world)` for each. Fails for cycles, a node with two parents, and
// indices out of range.
using NodeVisitor = std::function<void(const Fields& node, std::uint64_t index, const Mat4& world)>;
void for_each_node(const Fields& root, const NodeVisitor& visit);

// Column-major product: a after b.
Mat4 multiply(const Mat4& a, const Mat4& b);

}  // namespace pellucid
