// Internal to the module `asset`: makes glTF documents for models of other formats. In: a model and the draw
// order of each primitive. Out: a document, and where each primitive is in it.
#pragma once

#include <cstdint>
#include <vector>

#include "asset/gltf/document.h"

namespace pellucid {

// Where a primitive of a model is in a document, and in which order its triangles are stored there.
struct WrittenPrimitive {
  bool present = false;  // false: it has no vertices, which glTF cannot express
  std::uint32_t mesh = 0, index = 0;
  std::vector<std::uint32_t> base;  // triangles of the Primitive, in the order of primitive.indices
};

// Makes a document with one mesh for each primitive and one node for each instance of `model`. `bases[p]` is
// the draw order of primitive p. Triangles that glTF cannot hold (not finite, out of range) are left out.
// Fills `written`. Throws Error{nothing_to_do} for a model without any geometry.
GltfDocument make_minimal_document(const Model& model, const std::vector<std::vector<std::uint32_t>>& bases,
                                   std::vector<WrittenPrimitive>& written);

}  // namespace pellucid
