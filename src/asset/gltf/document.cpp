// Implements document.h: containers, buffers, and the layout of written files. Format: glTF 2.0, sections 3.6
// and 4.
#include "asset/gltf/document.h"

#include <cstring>
#include <filesystem>
#include <limits>

#include "asset/formats/text_cursor.h"
#include "asset/gltf/json_fields.h"
#include "asset/gltf/uris.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;

// The .glb container (section 4.4), which is little-endian.
constexpr std::uint32_t kGlbMagic = 0x46546C67;     // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;    // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;  // "BIN\0"
constexpr std::uint64_t kGlbHeaderBytes = 12;
constexpr std::uint64_t kGlbChunkHeaderBytes = 8;

constexpr std::size_t kMaxText = std::size_t{512} << 20U;
constexpr std::size_t kMaxDepth = 128;
constexpr std::size_t kMaxKeys = 10000;
constexpr std::size_t kMaxComplaint = 200;  // characters of the parser's own message

// Returns the message of the JSON parser, without its prefix "[json.exception.parse_error.101]" and cut to
// one line.
std::string parser_complaint(const std::string& what) {
  const std::size_t bracket = what.find("] ");
  std::string text = bracket == std::string::npos ? what : what.substr(bracket + 2);
  if (text.size() > kMaxComplaint) text = text.substr(0, kMaxComplaint) + "...";
  return text;
}

// Walks the text once without building anything, to find out whether it may be built.
class Guard : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool key(string_t&) override {
    if (++keys_.back() <= kMaxKeys) return true;
    complaint = "an object has more than " + std::to_string(kMaxKeys) + " keys";
    return false;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) override {
    complaint = parser_complaint(error.what());
    return false;
  }

  std::string complaint;

 private:
  bool open() {
    keys_.push_back(0);
    if (keys_.size() <= kMaxDepth) return true;
    complaint = "it nests deeper than " + std::to_string(kMaxDepth) + " levels";
    return false;
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  std::vector<std::size_t> keys_;  // per open object or array
};

// Parses JSON text, which may be hostile. Throws Error{bad_input}, beginning with `file`, for text that is
// not JSON, nests deeper than 128, has an object of more than 10,000 keys (ordered objects are searched in
// linear time), or is longer than 512 MiB.
Json parse_json(std::string_view text, const std::string& file) {
  const auto fail = [&](const std::string& reason) -> Error {
    return {ErrorKind::bad_input, file + ": bad JSON: " + reason};
  };
  if (text.size() > kMaxText) throw fail("longer than 512 MiB");
  Guard guard;
  if (!Json::sax_parse(text, &guard)) throw fail(guard.complaint);
  Json json = Json::parse(text);
  if (!json.is_object()) throw fail("it is not an object");
  return json;
}

// The limit for each buffer, which is that of read_file(), and for all buffers of a file together.
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

// Fills in the JSON and the other chunks. Returns the BIN chunk, or null if there is none.
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

// Returns whether the file exists beside the model. A URI that cannot be the name of a file, for example
// because it is too long, counts as missing.
bool is_beside(const GltfDocument& document, const std::string& uri) {
  std::error_code ignored;
  const fs::path folder = fs::path(document.path).parent_path();
  return fs::exists(folder / relative_path(folder, uri).value_or(""), ignored);
}

Bytes read_external(const GltfDocument& document, const Fields& buffer, const std::string& uri) {
  const fs::path folder = fs::path(document.path).parent_path();
  const auto relative = relative_path(folder, uri);
  if (!relative) {
    buffer.fail("uri " + in_quotes(uri, kLongestUri) +
                " is not a relative path; only files beside the model and data: are read");
  }
  const auto path = folder / *relative;
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
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
      if (!decoded) buffer.fail("the data: uri is malformed");
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

// Names from other formats need not be UTF-8, but JSON must be.
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
    throw Error(
        ErrorKind::bad_argument,
        path + ": a .glb holds at most 4 GiB; write a .gltf, or store the orders in a file of their own");
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

// Moves every buffer to its place in the new file.
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
  // Returns whether external files stay as they are. They do if the new file lies beside the old one and none
  // of them changes. Otherwise all get new names that belong to the new file, so that no file of another
  // model is ever overwritten.
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
