// Internal to the module `transparency`: meshes that one order draws right from everywhere, without a search.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"

namespace pellucid {

// Orders that are right from every viewpoint outside the mesh.
struct SimpleOrder {
  NodeSequence front_to_back;
  std::vector<std::uint32_t> base;  // every triangle once, back to front
};

// Returns the order of a mesh whose faces never hide each other in a way that depends on the view:
// - All faces lie in one plane. What the file draws later lies in front, as painted.
// - All faces lie on the hull of the mesh. Faces that show their outer side lie in front of all that show
// their
//   inner side, and neither overlap among themselves.
// Returns nothing for other meshes. Takes O((V + T) * T) for a hull of at most 2,000 triangles, and
// hardly more than O(V) for most other meshes.
std::optional<SimpleOrder> find_simple_order(const Mesh& mesh, const BoundingSphere& sphere, Facing facing);

}  // namespace pellucid
