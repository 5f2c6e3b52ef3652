// Internal to the module `asset`: what the readers of PLY, OBJ, STL and OFF share. It limits what a header
// may declare, turns polygons into triangles, repairs normals, and builds the model.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

// Returns the bytes of a file as text.
std::string_view text_of(const std::vector<std::byte>& bytes);

// Returns "bunny" for "dir/bunny.ply".
std::string file_stem(const std::string& path);

// Returns a model without primitives.
Model start_model(const std::string& path, const std::string& format);

// Reads a whole file. Throws Error{bad_input} where it is empty.
std::vector<std::byte> read_model_file(const std::string& path);

// Throws Error{bad_input} for more than options.max_elements of `what`, or for more than 32-bit indices can
// address.
void require_at_most(std::uint64_t count, const std::string& what, const std::string& path,
                     const ReadOptions& options);

// Throws Error{bad_input} if a header declares more than the rest of the file can hold. Called before memory
// is allocated for it.
void require_fits(std::uint64_t count, std::uint64_t least_bytes_each, std::uint64_t bytes_left,
                  const std::string& what, const std::string& path);

// Appends the triangles of one polygon, always corners - 2 of them (none below three corners). Quadrilaterals
// are split along the diagonal for which both halves face the same way. Other concave polygons of up to 4096
// corners are split by ear clipping (Meisters 1975), in O(n^2). All others become fans from the first corner.
// All indices must be in range.
void triangulate(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions,
                 std::vector<Triangle>& triangles);

// Makes all normals unit length. A normal without direction (zero, NaN) becomes the area-weighted normal of
// the faces, or +z if these have none either. A mesh without normals stays without them.
void repair_normals(Mesh& mesh);

// Returns "1 polygon", "2 polygons".
std::string counted(std::uint64_t count, const std::string& noun);

// Adds a note on faces with fewer than three corners, which draw nothing, where there are some.
void note_short_faces(std::uint64_t count, Model& model);

// Appends a primitive and the one node that draws it.
void add_primitive(Model& model, Primitive primitive);

// A material of an OBJ file (Wavefront MTL).
struct ObjMaterial {
  // The diffuse colour, and the opacity from `d` or, without it, 1 - `Tr`. MeshLab writes `Tr 1` without `d`
  // for opaque materials, so that combination is ignored.
  std::array<float, 4> base_color{1, 1, 1, 1};
};
using ObjMaterials = std::map<std::string, ObjMaterial, std::less<>>;  // by name

// Adds the materials of an MTL file; ignores lines that it does not understand. Declared here for fuzzing.
void parse_obj_materials(std::string_view text, ObjMaterials& materials);

}  // namespace pellucid
