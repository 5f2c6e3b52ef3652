// pellucid/asset.h - module `asset`: reads models and writes ordered glTF.
//
// In: glTF/GLB, PLY, OBJ, STL and OFF files. Out: glTF/GLB files with the extension
// PELLUCID_mesh_primitive_view_orders (docs/file-format.md, docs/schema/). A glTF that is read and written
// again loses nothing, because its JSON is changed in place: what pellucid does not understand stays as it
// was.
//
// Conventions: coordinates are right-handed, with +y up, in metres, and front faces are counter-clockwise
// (glTF 2.0, section 3.4). Coordinates of other formats are taken as they are.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "pellucid/split.h"

namespace pellucid {

enum class AlphaMode { opaque, mask, blend };

// Error statistics that are stored with an order set: means and maxima over held-out viewpoints. They are
// informative.
struct OrderErrorRecord {
  std::uint32_t viewpoints = 0;                     // their number
  std::uint32_t size = 0;                           // pixels per side of the images
  double ipr_mean = 0, ipr_max = 0, psnr_mean = 0;  // shares of covered pixels; dB
  struct ByDistance {
    double distance = 0, ipr = 0;  // bounding radii; mean share of covered pixels
  };
  std::vector<ByDistance> by_distance;
};

// One drawable primitive. Each primitive is ordered by itself.
struct Primitive {
  std::string name;  // name of the mesh, with "#k" for its k-th primitive if it has several
  // glTF: meshes[mesh_index].primitives[primitive_index]. Other formats: 0 and the number of the primitive.
  std::uint32_t mesh_index = 0;
  std::uint32_t primitive_index = 0;
  Mesh mesh;                 // strips, fans and polygons as triangles, in file order; not cleaned
  bool triangles = true;     // false: points or lines, which cannot be ordered
  bool double_sided = true;  // glTF: the material's flag; other formats: true
  bool deforms = false;      // skinned or morphed: orders of the static mesh are not valid
  // Other formats: opaque where a material says so, else blend.
  AlphaMode alpha_mode = AlphaMode::blend;
  std::array<float, 4> base_color{1, 1, 1, 1};
  std::string material_name;
  // The file says how opaque it is: any glTF, OBJ with a material that was found, and vertex colours that are
  // partly translucent.
  bool has_material = false;
  // Attributes that formats other than glTF have; those of a glTF stay in `document`. One entry per vertex of
  // the file (without `new_vertices`), or empty. Colours are linear. Texture coordinates run downwards from
  // the upper left corner, as in glTF.
  std::vector<std::array<float, 4>> colors;
  std::vector<std::array<float, 2>> texcoords;
  std::string texture;  // path of the image that multiplies the colour; empty: none
  // Set if the mesh was split after it was read (pellucid/split.h). Its last vertices are these, and its
  // triangles are the pieces. write_model() interpolates the attributes that only the document has.
  std::optional<std::vector<SplitVertex>> new_vertices;
  std::optional<OrderSet> orders;  // from the extension, checked; nodes refer to mesh.triangles
  std::optional<OrderErrorRecord> order_error;
};

// A node that draws a primitive, or one instance of a node with EXT_mesh_gpu_instancing.
struct Instance {
  std::string node_name;
  std::uint32_t primitive = 0;  // index into Model::primitives
  Mat4 world;                   // local to world, at rest
  std::uint32_t node = 0;       // glTF: index of the node
  Mat4 in_node{};               // local to the node: identity without instancing
};

struct GltfDocument;  // the original JSON and buffers, opaque

struct Model {
  std::string path;
  std::string format;  // "gltf", "glb", "ply", "obj", "stl", "off"; "sample" for make_model
  std::vector<Primitive> primitives;
  std::vector<Instance> instances;
  std::vector<std::string> animation_names;
  // What a user should know: "1 animation", "KHR_texture_transform kept, not read".
  std::vector<std::string> notes;
  // Names of extensions that the file requires and that pellucid does not understand. What is read may look
  // different in programs that do.
  std::vector<std::string> unknown_required;
  std::shared_ptr<const GltfDocument> document;  // null for other formats
};

inline bool is_gltf(const Model& model) {
  return model.format == "gltf" || model.format == "glb";
}

struct ReadOptions {
  // The largest number of vertices or triangles. A file that declares more is refused before memory is
  // allocated for them.
  std::uint64_t max_elements = 1ULL << 28U;
};
// Reads a model file. Formats that identify themselves in their first bytes (glTF, GLB, PLY) are recognised
// by these, others by the extension of the file name. Takes time and memory proportional to the size of the
// file. Throws Error{bad_input} that names the file, the reason and, where it helps, the place (line, byte,
// accessor).
Model read_model(const std::string& path, const ReadOptions& options = {});

// How the orders are stored.
enum class OrderEncoding {
  indices,  // plain index accessors, 16-bit where the vertex count allows
  patches,  // permutations of patch (here: triangle) ids, a third of the size
  // The same, compressed by EXT_meshopt_compression. Files that do not require that extension must also hold
  // an uncompressed copy. The copy goes to OUT.orders-fallback.bin, which viewers that know the extension do
  // not fetch.
  meshopt,
};

struct OrderedPrimitive {
  std::uint32_t primitive = 0;  // index into Model::primitives
  OrderSet orders;              // nodes refer to Model::primitives[primitive].mesh.triangles
  std::optional<OrderErrorRecord> error;
};

struct WriteOptions {
  OrderEncoding encoding = OrderEncoding::indices;
  SortDirection direction = SortDirection::front_to_back;
  // Stores the orders in OUT.orders.bin, which viewers that do not know orders never fetch.
  bool split_buffer = false;
  bool bake_base = true;  // primitive.indices becomes the best single order
  // Textures in files beside a glTF: written into another folder, a .glb holds them, and a .gltf gets copies
  // beside it. With `embed_textures` the file holds them in any case.
  bool embed_textures = false;
};
struct WriteReport {
  std::uint64_t file_bytes = 0;   // all files written
  std::uint64_t order_bytes = 0;  // those of the orders and their table as stored, without a fallback copy
  std::vector<std::string> files;
  std::vector<std::string>
      notes;  // textures that are missing, and files of an earlier run that are not used now
};
// Writes `model` with the given orders as .glb or .gltf, by the extension of `path`. Models of other formats
// get a minimal document of their own. The file holds exactly the given orders. Orders that came with `model`
// and are not given again are removed, so an empty list removes all. The base order in the file is
// `base_sequence`, followed by the triangles that it leaves out. Primitives that were split get accessors of
// their own. Each file is written completely or not at all. The same input gives the same bytes. Throws
// Error{cannot_write}, Error{bad_argument} if the orders do not fit the model, and Error{nothing_to_do} for a
// model without geometry.
WriteReport write_model(const Model& model, const std::vector<OrderedPrimitive>& ordered,
                        const std::string& path, const WriteOptions& options = {});

// Makes a model of meshes that a program has made (samples, tests), with one glTF mesh and one node per part.
Model make_model(const std::vector<SamplePart>& parts, const std::string& name);

// Returns whether the triangles of a primitive may differ from those of its file. They may not if it has an
// extension that may refer to triangles by number.
bool triangles_may_change(const Model& model, std::uint32_t primitive);

// Returns whether the file says that the primitive is blended. Formats that say nothing about opacity do not
// count, although `order` takes their meshes as translucent sheets.
bool is_known_translucent(const Model& model, const Primitive& primitive);

// Returns the bytes that the index data of an order set takes in memory when it is drawn, with 2 or 4 bytes
// per index.
std::uint64_t index_bytes(const OrderSet& set, const Mesh& mesh);

// --------------------------------------------------------------------------------------------------- cameras

// A camera of a glTF (glTF 2.0, section 3.10). It looks along its own -z, and +y is up.
struct ModelCamera {
  std::string name;  // of the camera or, if it has none, of its node
  Mat4 world;        // camera to world, as the default scene places it at rest
  bool perspective = true;
  // Perspective: tangent of half the vertical angle. Orthographic: half the height of the image, world units.
  double half_height = 1;
};

// Returns the cameras of the default scene in the order of its nodes, and none for formats other than glTF.
// Throws Error{bad_input} that names the file and the place.
std::vector<ModelCamera> read_cameras(const Model& model);

// ----------------------------------------------------------------------------------------------- image files

// Returns `image` as an 8-bit RGB PNG file in memory; pellucid/material.h reads image files. The same image
// gives the same bytes. Throws Error{bad_argument} if the image is empty or its size does not fit its bytes.
std::vector<std::uint8_t> encode_png(const Image& image);
// Writes the same bytes to a file, completely or not at all. Throws Error{bad_argument} as above, and
// Error{cannot_write}.
void write_png(const Image& image, const std::string& path);

}  // namespace pellucid
