// Internal to the module `asset`: models of other formats as glTF documents.
#pragma once

#include <vector>

#include "asset/gltf_document.h"

namespace pellucid {

// Where a primitive of a model lies in a document, and in which order its triangles are drawn there.
struct WrittenPrimitive {
  bool present = false;  // false: it has no vertices, and glTF can not say that
  std::uint32_t mesh = 0, index = 0;
  std::vector<std::uint32_t> base;  // triangles of the Primitive, in the order of primitive.indices
};

// One mesh for each primitive and one node for each instance of `model`. `bases[p]` is the drawing order of
// primitive p; triangles that glTF can not hold (not finite, out of range) are left out of it. Fills
// `written`. Throws Error{nothing_to_do} for a model without any geometry.
GltfDocument make_minimal_document(const Model& model, const std::vector<std::vector<std::uint32_t>>& bases,
                                   std::vector<WrittenPrimitive>& written);

}  // namespace pellucid
