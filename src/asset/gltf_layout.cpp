// A document becomes files: see lay_out in gltf_document.h.
#include <filesystem>
#include <limits>

#include "asset/glb.h"
#include "asset/gltf_document.h"
#include "asset/json_fields.h"
#include "asset/uri.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return fs::weakly_canonical(folder.empty() ? fs::path(".") : folder);
}

void append_u32(Bytes& bytes, std::uint64_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<std::byte>((value >> shift) & 255U));
}

void append_padded(Bytes& out, const Bytes& bytes, std::byte padding) {
  out.insert(out.end(), bytes.begin(), bytes.end());
  while (out.size() % 4 != 0) out.push_back(padding);
}

void append_chunk(Bytes& out, std::uint32_t type, const Bytes& bytes, std::byte padding) {
  append_u32(out, (bytes.size() + 3) / 4 * 4);
  append_u32(out, type);
  append_padded(out, bytes, padding);
}

Bytes to_bytes(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

// Names from other formats need not be UTF-8; JSON must be.
std::string text_of_json(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Bytes glb_bytes(const GltfDocument& document, const std::string& path) {
  const Bytes json = to_bytes(text_of_json(document.json, -1));
  const Bytes* binary = nullptr;
  if (!document.buffers.empty() && document.buffers[0].storage == BufferStorage::binary_chunk) {
    binary = document.buffers[0].bytes.get();
  }
  std::uint64_t total = kGlbHeaderBytes + kGlbChunkHeaderBytes + (json.size() + 3) / 4 * 4;
  if (binary != nullptr) total += kGlbChunkHeaderBytes + (binary->size() + 3) / 4 * 4;
  for (const GlbChunk& chunk : document.chunks)
    total += kGlbChunkHeaderBytes + (chunk.bytes.size() + 3) / 4 * 4;
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorKind::bad_argument,
                path + ": a .glb holds at most 4 GiB; write .gltf or split the orders off");
  }

  Bytes out;
  out.reserve(total);
  append_u32(out, kGlbMagic);
  append_u32(out, 2);
  append_u32(out, total);
  append_chunk(out, kJsonChunk, json, std::byte{' '});
  if (binary != nullptr) append_chunk(out, kBinaryChunk, *binary, std::byte{0});
  for (const GlbChunk& chunk : document.chunks) append_chunk(out, chunk.type, chunk.bytes, std::byte{0});
  return out;
}

// Puts every buffer where the new file wants it.
class BufferPlacer {
 public:
  BufferPlacer(GltfDocument& document, const std::string& path, const std::vector<std::string>& side_names)
      : document_(document),
        side_names_(side_names),
        folder_(fs::path(path).parent_path()),
        stem_(fs::path(path).stem().string()),
        glb_(fs::path(path).extension() == ".glb"),
        keep_external_(may_keep_external(path)) {}

  std::vector<std::pair<std::string, Bytes>> place_all() {
    for (std::size_t i = 0; i < document_.buffers.size(); ++i) place(i);
    return std::move(side_files_);
  }

 private:
  // External files stay what they are when the new file lies beside the old one and none of them changes;
  // else all get names of the new file's own, so that no other model's file is ever overwritten.
  [[nodiscard]] bool may_keep_external(const std::string& path) const {
    if (glb_ || document_.path.empty() || folder_of(path) != folder_of(document_.path)) return false;
    for (const GltfBuffer& buffer : document_.buffers) {
      if (buffer.storage == BufferStorage::external && buffer.changed) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_side(std::size_t i) const {
    return i < side_names_.size() && !side_names_[i].empty();
  }

  void place(std::size_t i) {
    GltfBuffer& buffer = document_.buffers[i];
    Json& json = document_.json["buffers"][i];
    if (buffer.bytes == nullptr) return;  // nothing to place
    if (buffer.changed) json["byteLength"] = buffer.bytes->size();
    if (is_side(i)) {
      make_external(buffer, json, side_names_[i]);
    } else if (glb_ && i == 0) {
      json.erase("uri");
      buffer.storage = BufferStorage::binary_chunk;
    } else if (glb_ || buffer.storage == BufferStorage::data_uri) {
      if (buffer.storage == BufferStorage::data_uri && !buffer.changed) return;
      json["uri"] = encode_data_uri(*buffer.bytes);
      buffer.storage = BufferStorage::data_uri;
    } else if (buffer.storage != BufferStorage::external || !keep_external_) {
      make_external(buffer, json, i == 0 ? stem_ + ".bin" : stem_ + '.' + std::to_string(i) + ".bin");
    }
  }

  void make_external(GltfBuffer& buffer, Json& json, const std::string& name) {
    json["uri"] = encode_relative_uri(name);
    buffer.storage = BufferStorage::external;
    side_files_.emplace_back((folder_ / name).string(), *buffer.bytes);
  }

  GltfDocument& document_;
  const std::vector<std::string>& side_names_;
  fs::path folder_;
  std::string stem_;
  bool glb_;
  bool keep_external_;
  std::vector<std::pair<std::string, Bytes>> side_files_;
};

}  // namespace

DocumentFiles lay_out(GltfDocument& document, const std::string& path,
                      const std::vector<std::string>& side_names) {
  DocumentFiles files;
  files.side_files = BufferPlacer(document, path, side_names).place_all();
  if (fs::path(path).extension() == ".glb") {
    files.main = glb_bytes(document, path);
  } else {
    files.main = to_bytes(text_of_json(document.json, 2) + "\n");
  }
  return files;
}

}  // namespace pellucid
