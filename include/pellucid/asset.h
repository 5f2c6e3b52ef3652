// pellucid/asset.h - module `asset`: models in, ordered glTF out.
//
// In: glTF/GLB (all that is not understood is kept), PLY, OBJ, STL, OFF. Out: glTF/GLB with the extension
// PELLUCID_mesh_primitive_view_orders (docs/file-format.md, docs/schema/). A glTF that passes through loses
// nothing: the original JSON is patched in place, never re-generated.
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

// Error statistics that travel with an order set in the file (informative).
struct OrderErrorRecord {
  std::uint32_t viewpoints = 0;
  std::uint32_t size = 0;
  double ipr_mean = 0, ipr_max = 0, psnr_mean = 0;
  struct ByDistance {
    double distance = 0, ipr = 0;
  };
  std::vector<ByDistance> by_distance;
};

// One drawable primitive: what is ordered by itself.
struct Primitive {
  std::string name;              // mesh name, with "#k" for its k-th primitive where it has several
  std::uint32_t mesh_index = 0;  // glTF: meshes[mesh_index].primitives[primitive_index]; else 0, running
  std::uint32_t primitive_index = 0;
  Mesh mesh;                 // triangles after decoding strips, fans, polygons; in file order; not cleaned
  bool triangles = true;     // false: points or lines, nothing to order
  bool double_sided = true;  // glTF: the material's flag; other formats: true
  bool deforms = false;      // skinned or morphed: static orders do not hold
  AlphaMode alpha_mode = AlphaMode::blend;  // other formats: blend
  std::array<float, 4> base_color{1, 1, 1, 1};
  std::string material_name;
  bool has_material = false;  // the file says how it looks: any glTF, OBJ with a material that was found
  // The mesh was split since it was read (pellucid/split.h): its last vertices are these, and its triangles
  // are the pieces. write_model interpolates the attributes that only the document knows.
  std::optional<std::vector<SplitVertex>> new_vertices;
  std::optional<OrderSet> orders;  // from the extension, validated; nodes refer to mesh.triangles
  std::optional<OrderErrorRecord> order_error;
};

// A node that draws a primitive.
struct Instance {
  std::string node_name;
  std::uint32_t primitive = 0;  // index into Model::primitives
  Mat4 world;                   // local to world
};

struct GltfDocument;  // original JSON and buffers, opaque

struct Model {
  std::string path;
  std::string format;  // "gltf", "glb", "ply", "obj", "stl", "off"; "sample" for make_model
  std::vector<Primitive> primitives;
  std::vector<Instance> instances;
  std::vector<std::string> animation_names;
  std::vector<std::string>
      notes;  // things a user should know: "1 animation", "KHR_texture_transform kept, not read"
  std::shared_ptr<const GltfDocument> document;  // null for other formats
};

inline bool is_gltf(const Model& model) {
  return model.format == "gltf" || model.format == "glb";
}

struct ReadOptions {
  // Refuse before allocating when a header or accessor asks for more than this many vertices or triangles.
  std::uint64_t max_elements = 1ULL << 28U;
};
// Throws Error{bad_input} naming the file, the reason and, where it helps, the place (line, byte, accessor).
Model read_model(const std::string& path, const ReadOptions& options = {});

// How the orders are stored.
enum class OrderEncoding {
  indices,  // plain index accessors, 16-bit where the vertex count allows
  patches,  // permutations of patch (here: triangle) ids, a third of the size
  meshopt,  // the same, as EXT_meshopt_compression; their uncompressed copy, which that extension demands of
            // files that do not require it, goes to OUT.orders-fallback.bin and is fetched by nobody
};
enum class SortDirection { front_to_back, back_to_front };

struct OrderedPrimitive {
  std::uint32_t primitive = 0;  // index into Model::primitives
  OrderSet orders;              // nodes refer to Model::primitives[primitive].mesh.triangles
  std::optional<OrderErrorRecord> error;
};

struct WriteOptions {
  OrderEncoding encoding = OrderEncoding::indices;
  SortDirection direction = SortDirection::front_to_back;
  bool split_buffer = false;  // orders go to OUT.orders.bin, which viewers that do not know them never fetch
  bool bake_base = true;      // primitive.indices becomes the best single order
};
struct WriteReport {
  std::uint64_t file_bytes = 0;   // all files written
  std::uint64_t order_bytes = 0;  // of these, for orders and their table, as stored (without a fallback copy)
  std::vector<std::string> files;
};
// Write `model` with the given orders as .glb or .gltf (by extension of `path`). Models of other formats get
// a minimal document of their own. The file holds exactly the given orders: those that `model` came with and
// are not given again are taken out, so an empty list strips it. Triangles that `base_sequence` leaves out
// follow at its end. Primitives that were split get accessors of their own. Files appear whole or not at all.
// Same input, same bytes. Throws Error{cannot_write | bad_argument}, Error{nothing_to_do} for a model without
// geometry.
WriteReport write_model(const Model& model, const std::vector<OrderedPrimitive>& ordered,
                        const std::string& path, const WriteOptions& options = {});

// A model of meshes made by a program (samples, tests): one glTF mesh and node per part.
Model make_model(const std::vector<SamplePart>& parts, const std::string& name);

// May the triangles of a primitive be others than those of the file? False where it has an extension that may
// number them.
bool triangles_may_change(const Model& model, std::uint32_t primitive);

// Bytes that the index data of an order set takes in memory when drawn: 2 or 4 bytes an index.
std::uint64_t index_bytes(const OrderSet& set, const Mesh& mesh);

// Write an 8-bit RGB PNG through a temporary file. Throws Error{cannot_write}.
void write_png(const Image& image, const std::string& path);
// The same bytes in memory.
std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace pellucid
