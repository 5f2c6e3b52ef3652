// Internal to the module `asset`: which accessors of a document may be overwritten in place.
#pragma once

#include <vector>

#include "asset/gltf_document.h"

namespace pellucid {

// One flag per accessor: exactly one primitive draws with it as its indices, nothing else refers to it, and
// no other view or accessor shares a byte with it. Sparse, compressed and strided accessors never qualify.
std::vector<bool> exclusive_index_accessors(const GltfDocument& document);

}  // namespace pellucid
