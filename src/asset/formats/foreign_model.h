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
#include "pellucid/material.h"

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
// are split along the diagonal for which both halves face the same way. Other concave polygons are split by
// ear clipping, seen along their normal, with exact predicates: the triangles of a simple polygon cover
// exactly its area, also where holes are joined to the outline by edges that are walked twice. Polygons that
// intersect themselves give some triangles of their corners. Takes O(n) for convex polygons, and expected O(n
// log n) for others. All indices must be in range.
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

// Returns the linear colour that a vertex colour of PLY, OBJ or OFF means. These formats store what a screen
// shows (sRGB), 0..1, with linear opacity. Values outside, and NaN, are clamped.
std::array<float, 4> vertex_color(float red, float green, float blue, float alpha);

// Replaces vertex colours as they stand in a file by vertex_color() of them. They are either numbers up to 1,
// or, where some is greater, bytes. A negative opacity means that the vertex has none, and three negative
// colours that it has no colour, which is white.
void finish_colors(std::vector<std::array<float, 4>>& colors);

// Sets the opacity that the file states: its material (base colour), or vertex colours of which some are
// translucent. `states_opacity`: the file has a material for the primitive.
void set_alpha_mode(Primitive& primitive, bool states_opacity);

// Returns the path of a file that a model names. The name may have quotation marks, blanks, and the
// backslashes, drive letters and wrong case of a file that was made on Windows. Returns an empty path if
// there is no such file; devices and pipes do not count.
std::string find_beside(const std::string& model_path, std::string_view name);

// Returns the path of an image as find_beside() does, beside the model or beside `other_path`. Where it is
// missing, or neither PNG nor JPEG, returns an empty text and adds a note that begins with `owner`.
std::string find_texture(Model& model, const std::string& owner, const std::string& name,
                         const std::string& other_path = {});

// Returns the looks of a model of a format other than glTF. See read_materials().
Materials read_foreign_materials(const Model& model, const MaterialOptions& options);

// Splits a list of names at blanks outside quotation marks.
std::vector<std::string> split_names(std::string_view names);

// A material of an OBJ file (Wavefront MTL).
struct ObjMaterial {
  // The diffuse colour, and the opacity from `d` or, without it, 1 - `Tr`. MeshLab writes `Tr 1` without `d`
  // for opaque materials, so that combination is ignored.
  std::array<float, 4> base_color{1, 1, 1, 1};
  std::string texture;         // name of the image of the diffuse colour (map_Kd), without options
  std::string opacity_map;     // name of the image of the opacity (map_d)
  std::string library;         // path of the MTL file
  bool moves_texture = false;  // with options that scale or move it
};
using ObjMaterials = std::map<std::string, ObjMaterial, std::less<>>;  // by name

// Adds the materials of an MTL file; ignores lines that it does not understand. Throws Error{bad_input} for
// text in UTF-16. Declared here for fuzzing.
void parse_obj_materials(std::string_view text, ObjMaterials& materials);

}  // namespace pellucid
