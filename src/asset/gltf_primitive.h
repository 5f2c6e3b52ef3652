// Internal to the module `asset`: one glTF mesh primitive becomes a Primitive.
#pragma once

#include "asset/accessor_reader.h"

namespace pellucid {

// `fields` is meshes[mesh].primitives[index]; `root` the whole document. Fills everything but mesh_index,
// primitive_index, name and deforms-by-skin.
Primitive read_primitive(const Fields& root, const Fields& fields, AccessorReader& accessors);

// glTF's default for a missing `mode`: 4, triangles.
std::uint64_t primitive_mode(const Fields& primitive);

}  // namespace pellucid
