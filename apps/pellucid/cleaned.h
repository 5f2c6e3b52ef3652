// Orders are made for clean meshes and stored for the file's own triangles: the way there and back.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pellucid/asset.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"

namespace pellucid::cli {

// Only the vertices that triangles use, in their order.
Mesh compacted(const Mesh& mesh);

// Does it have orders that promise right pictures of translucent faces? Overdraw orders are none.
bool has_transparency_orders(const Primitive& primitive);

// A primitive as it is measured and drawn: clean, its orders (if any) referring to the clean mesh.
struct CleanPrimitive {
  Mesh mesh;
  std::optional<OrderSet> orders;           // for transparency
  std::optional<OrderSet> overdraw_orders;  // for opaque faces
};
CleanPrimitive clean_primitive(const Primitive& primitive);

}  // namespace pellucid::cli
