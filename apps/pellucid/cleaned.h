// Meshes as they are written to a new file. In: a mesh. Out: the same mesh without unused vertices.
#pragma once

#include "pellucid/mesh.h"

namespace pellucid::cli {

// Returns the mesh with only the vertices that its triangles use, in the same order.
Mesh compacted(const Mesh& mesh);

}  // namespace pellucid::cli
