// Internal to the module `asset`: a glTF file as it is stored on disk. In: a .gltf or .glb. Out: its JSON and
// its buffers without interpretation, which can be written again. Format: glTF 2.0, sections 3.6 and 4.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::byte>;

constexpr const char* kOrderExtension = "PELLUCID_mesh_primitive_view_orders";
constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";
constexpr const char* kKhrMeshoptExtension = "KHR_meshopt_compression";

// Targets of buffer views.
constexpr std::uint32_t kVertexTarget = 34962;  // ARRAY_BUFFER
constexpr std::uint32_t kIndexTarget = 34963;   // ELEMENT_ARRAY_BUFFER

// Where a buffer's bytes come from. They go to the same place when the file is written again.
enum class BufferStorage {
  binary_chunk,  // the BIN chunk of a .glb: buffers[0] without a uri
  data_uri,      // in the JSON text
  external,      // a file beside the model
  absent,        // no bytes: the placeholder of EXT_meshopt_compression
};

struct GltfBuffer {
  BufferStorage storage = BufferStorage::absent;
  std::shared_ptr<const Bytes> bytes;  // exactly buffer.byteLength bytes; null if absent
  bool changed = false;                // differs from the data at its uri
};

// A chunk of a .glb that is neither JSON nor BIN. The container format asks programs to keep it.
struct GlbChunk {
  std::uint32_t type = 0;
  Bytes bytes;
};

// The JSON library marks its move constructor noexcept; the check does not believe it.
struct GltfDocument {  // NOLINT(bugprone-exception-escape)
  std::string path;    // external files are relative to its folder; empty for a document made in memory
  Json json;
  std::vector<GltfBuffer> buffers;
  std::vector<GlbChunk> chunks;
};

// Parses the file at `path`, a .gltf or .glb by its first bytes, and loads every buffer that it names. Throws
// Error{bad_input} for files that are damaged or hostile. The JSON text is limited in size, depth and keys
// per object.
GltfDocument load_document(const std::string& path);

// The files that a document becomes.
struct DocumentFiles {
  std::vector<std::pair<std::string, Bytes>> side_files;  // path and content; written first
  Bytes main;
};
// Lays `document` out as the file `path` (.glb or .gltf by extension) and its side files. Changes the JSON of
// the document where a buffer moves (uri, byteLength). If `side_names[i]` is not empty, buffer i becomes the
// external file of that name. Throws Error{bad_argument} if a .glb would exceed 4 GiB.
DocumentFiles lay_out(GltfDocument& document, const std::string& path,
                      const std::vector<std::string>& side_names);

}  // namespace pellucid
