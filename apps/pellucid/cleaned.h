// Meshes as they are written to a new file. In: a mesh. Out: the same mesh without unused vertices.
#pragma once

#include "pellucid/asset.h"
#include "pellucid/mesh.h"

namespace pellucid::cli {

// Returns the mesh with only the vertices that its triangles use, in the same order. `kept`, unless null,
// receives their old numbers.
Mesh compacted(const Mesh& mesh, std::vector<std::uint32_t>* kept = nullptr);

// Cleans the mesh of a primitive of a format other than glTF and removes unused vertices with their
// attributes. Such models are written anew, so what cannot be drawn is left out of the output as well.
void clean_for_writing(Primitive& primitive, const CleanOptions& options);

}  // namespace pellucid::cli
