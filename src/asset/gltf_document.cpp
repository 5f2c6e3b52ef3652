// Load a .gltf or .glb with all its buffers: see gltf_document.h. Format: glTF 2.0, sections 3.6 and 4.
#include "asset/gltf_document.h"

#include <cstring>
#include <filesystem>

#include "asset/formats/text_cursor.h"
#include "asset/glb.h"
#include "asset/gltf_json.h"
#include "asset/json_fields.h"
#include "asset/uri.h"

namespace pellucid {
namespace {

// All buffers of one file together, and each of them: the limit of read_file.
constexpr std::uint64_t kMaxBufferBytes = std::uint64_t{8} << 30U;

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw Error(ErrorKind::bad_input, path + ": " + reason);
}

std::uint32_t read_u32(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

std::string_view text_within(const Bytes& bytes, std::size_t begin, std::size_t count) {
  return {reinterpret_cast<const char*>(bytes.data()) + begin, count};
}

// Fill in the JSON and the other chunks; returns the BIN chunk, null where there is none.
std::shared_ptr<const Bytes> parse_glb(const Bytes& file, GltfDocument& document) {
  const std::string& path = document.path;
  if (file.size() < kGlbHeaderBytes) fail(path, "the .glb header is cut off");
  if (read_u32(file, 4) != 2) {
    fail(path, "glTF container version " + std::to_string(read_u32(file, 4)) + " is not 2");
  }
  const std::uint64_t length = read_u32(file, 8);
  if (length > file.size()) {
    fail(path, "it is cut off: the header says " + std::to_string(length) + " bytes, the file has " +
                   std::to_string(file.size()));
  }

  std::shared_ptr<const Bytes> binary;
  bool json_seen = false;
  std::uint64_t at = kGlbHeaderBytes;
  while (at + kGlbChunkHeaderBytes <= length) {
    const std::uint64_t count = read_u32(file, at);
    const std::uint32_t type = read_u32(file, at + 4);
    at += kGlbChunkHeaderBytes;
    if (count > length - at) fail(path, "a chunk is cut off at byte " + std::to_string(at));
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(at);
    if (!json_seen) {
      if (type != kJsonChunk) fail(path, "the first chunk is not JSON");
      document.json = parse_json(text_within(file, at, count), path);
      json_seen = true;
    } else if (type == kBinaryChunk && binary == nullptr) {
      binary = std::make_shared<const Bytes>(begin, begin + static_cast<std::ptrdiff_t>(count));
    } else {
      document.chunks.push_back({type, Bytes(begin, begin + static_cast<std::ptrdiff_t>(count))});
    }
    at += count;
  }
  if (!json_seen) fail(path, "it has no JSON chunk");
  return binary;
}

bool is_fallback(const Fields& buffer) {
  for (const char* name : {kMeshoptExtension, kKhrMeshoptExtension}) {
    const auto extension = buffer.extension(name);
    if (extension && extension->flag_or("fallback", false)) return true;
  }
  return false;
}

// False also for what can be no file's name, such as one that is too long.
bool is_beside(const GltfDocument& document, const std::string& uri) {
  std::error_code ignored;
  return std::filesystem::exists(
      std::filesystem::path(document.path).parent_path() / decode_relative_uri(uri).value_or(""), ignored);
}

Bytes read_external(const GltfDocument& document, const Fields& buffer, const std::string& uri) {
  const auto relative = decode_relative_uri(uri);
  if (!relative) {
    buffer.fail("uri " + in_quotes(uri, kLongestUri) +
                " is not a relative path; only files beside the model and data: are read");
  }
  const auto path = std::filesystem::path(document.path).parent_path() / *relative;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    buffer.fail("the file " + in_quotes(*relative, kLongestUri) + " is missing or not a regular file");
  }
  try {
    return read_file(path.string());
  } catch (const Error& error) {
    buffer.fail(error.what());
  }
}

GltfBuffer load_buffer(const GltfDocument& document, const Fields& buffer, std::uint64_t i,
                       const std::shared_ptr<const Bytes>& binary) {
  const std::uint64_t length = buffer.index("byteLength");
  GltfBuffer loaded;
  Bytes bytes;
  if (!buffer.has("uri")) {
    if (i != 0 || binary == nullptr) return loaded;
    loaded.storage = BufferStorage::binary_chunk;
    bytes = *binary;
  } else {
    const std::string uri = buffer.text("uri");
    if (is_data_uri(uri)) {
      loaded.storage = BufferStorage::data_uri;
      auto decoded = decode_data_uri(uri);
      if (!decoded) buffer.fail("the data: uri is not well-formed base64");
      bytes = std::move(*decoded);
    } else {
      loaded.storage = BufferStorage::external;
      // The uncompressed copy of compressed data is never read, so it may be missing.
      if (is_fallback(buffer) && !is_beside(document, uri)) return loaded;
      bytes = read_external(document, buffer, uri);
    }
  }
  if (bytes.size() < length) {
    buffer.fail("it is cut off: byteLength is " + std::to_string(length) + ", there are " +
                std::to_string(bytes.size()) + " bytes");
  }
  bytes.resize(length);
  loaded.bytes = std::make_shared<const Bytes>(std::move(bytes));
  return loaded;
}

void load_buffers(GltfDocument& document, const std::shared_ptr<const Bytes>& binary) {
  const Fields root(document.path, document.json, "");
  std::uint64_t total = 0;
  for (std::uint64_t i = 0; i < root.size("buffers"); ++i) {
    const Fields buffer = root.element("buffers", i);
    document.buffers.push_back(load_buffer(document, buffer, i, binary));
    const auto& bytes = document.buffers.back().bytes;
    total += bytes == nullptr ? 0 : bytes->size();
    if (total > kMaxBufferBytes) fail(document.path, "its buffers are larger than 8 GiB together");
  }
}

void check_version(const GltfDocument& document) {
  const Fields asset = Fields(document.path, document.json, "").object("asset");
  const std::string version = asset.text("version");
  if (!version.starts_with("2.")) {
    asset.fail("glTF version " + in_quotes(version) + " is not read, only 2.x");
  }
  const std::string minimum = asset.text_or("minVersion", "2.0");
  if (minimum != "2.0") asset.fail("minVersion " + in_quotes(minimum) + " is newer than 2.0");
}

}  // namespace

GltfDocument load_document(const std::string& path) {
  GltfDocument document;
  document.path = path;
  const Bytes file = read_file(path);
  std::shared_ptr<const Bytes> binary;
  if (file.size() >= 4 && read_u32(file, 0) == kGlbMagic) {
    binary = parse_glb(file, document);
  } else {
    document.json = parse_json(text_within(file, 0, file.size()), path);
  }
  check_version(document);
  load_buffers(document, binary);
  return document;
}

}  // namespace pellucid
