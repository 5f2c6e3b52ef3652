// Meshes as they are written to a new file.
#pragma once

#include "pellucid/mesh.h"

namespace pellucid::cli {

// Only the vertices that triangles use, in their order.
Mesh compacted(const Mesh& mesh);

}  // namespace pellucid::cli
