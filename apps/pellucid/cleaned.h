// The clean mesh of a primitive of a file, with the orders that the file has. In: a primitive as it was read.
// Out: its mesh without triangles that draw nothing, and its orders for these triangles.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pellucid/asset.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"

namespace pellucid::cli {

// Returns the mesh with only the vertices that its triangles use, in the same order.
Mesh compacted(const Mesh& mesh);

// Returns whether a primitive has transparency orders. Overdraw orders are none.
bool has_transparency_orders(const Primitive& primitive);

// A primitive as it is measured and drawn. Orders, if there are any, refer to the clean mesh.
struct CleanPrimitive {
  Mesh mesh;
  std::optional<OrderSet> orders;           // for transparency
  std::optional<OrderSet> overdraw_orders;  // for opaque faces
};
CleanPrimitive clean_primitive(const Primitive& primitive);

}  // namespace pellucid::cli
