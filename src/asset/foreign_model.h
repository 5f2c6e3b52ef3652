// Internal to the module `asset`: what the readers of PLY, OBJ, STL and OFF share.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

std::string_view text_of(const std::vector<std::byte>& bytes);

// "dir/bunny.ply" -> "bunny".
std::string file_stem(const std::string& path);

// A model without primitives yet.
Model start_model(const std::string& path, const std::string& format);

// A file as the reader wants it: Error{bad_input} where it is empty.
std::vector<std::byte> read_model_file(const std::string& path);

// Refuses more than options.max_elements (or what 32-bit indices reach) of `what`.
void require_at_most(std::uint64_t count, const std::string& what, const std::string& path,
                     const ReadOptions& options);

// Refuses a header's count that the rest of the file cannot hold, before anything is allocated for it.
void require_fits(std::uint64_t count, std::uint64_t least_bytes_each, std::uint64_t bytes_left,
                  const std::string& what, const std::string& path);

// Appends the triangles of one polygon: always corners - 2 (none below three corners). Quadrilaterals are
// split along the diagonal on which both halves agree, other concave polygons by ear clipping (of at most
// 4096 corners, O(n^2)); convex ones are fans from the first corner. All indices must be in range.
void triangulate(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions,
                 std::vector<Triangle>& triangles);

// Makes all normals unit length; those that have no direction (zero, NaN) become the area-weighted one, or +z
// where there is none either. Empty normals stay empty.
void repair_normals(Mesh& mesh);

// "1 polygon", "2 polygons".
std::string counted(std::uint64_t count, const std::string& noun);

// Faces that draw nothing because they have fewer than three corners: a note where there are some.
void note_short_faces(std::uint64_t count, Model& model);

// Append a primitive and the one node that draws it.
void add_primitive(Model& model, Primitive primitive);

}  // namespace pellucid
