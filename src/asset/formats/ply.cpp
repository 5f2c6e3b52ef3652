// Reads PLY files: text and binary in both byte orders, polygons and triangle strips, any scalar types. Skips
// elements and properties that are not geometry. Format: Turk, "The PLY polygon file format", 1994.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      break;
  }
  return 8;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // Returns the least size of one such element in the file. A word of text takes one byte and a separator.
  [[nodiscard]] std::uint64_t least_bytes(PlyFormat format) const {
    std::uint64_t bytes = 0;
    for (const PlyProperty& property : properties) {
      bytes += format == PlyFormat::ascii ? 2 : byte_size(property.count_type.value_or(property.type));
    }
    return bytes;
  }
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t body_begin = 0;   // byte where the data begins
  std::uint64_t body_line = 0;  // its line
};

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypeNames{{{"char", PlyType::int8},
                                                                           {"int8", PlyType::int8},
                                                                           {"uchar", PlyType::uint8},
                                                                           {"uint8", PlyType::uint8},
                                                                           {"short", PlyType::int16},
                                                                           {"int16", PlyType::int16},
                                                                           {"ushort", PlyType::uint16},
                                                                           {"uint16", PlyType::uint16},
                                                                           {"int", PlyType::int32},
                                                                           {"int32", PlyType::int32},
                                                                           {"uint", PlyType::uint32},
                                                                           {"uint32", PlyType::uint32},
                                                                           {"float", PlyType::float32},
                                                                           {"float32", PlyType::float32},
                                                                           {"double", PlyType::float64},
                                                                           {"float64", PlyType::float64}}};

PlyType read_type(TextCursor& cursor) {
  const std::string_view word = cursor.token_on_line();
  const auto* const found = std::find_if(kTypeNames.begin(), kTypeNames.end(),
                                         [&](const auto& entry) { return entry.first == word; });
  if (found == kTypeNames.end()) throw cursor.error("unknown property type " + in_quotes(word));
  return found->second;
}

PlyFormat read_format(TextCursor& cursor) {
  const std::string_view word = cursor.token_on_line();
  if (word == "ascii") return PlyFormat::ascii;
  if (word == "binary_little_endian") return PlyFormat::binary_little_endian;
  if (word == "binary_big_endian") return PlyFormat::binary_big_endian;
  throw cursor.error("unknown PLY format " + in_quotes(word));
}

PlyElement read_element(TextCursor& cursor) {
  PlyElement element;
  element.name = cursor.token_on_line();
  const std::string_view word = cursor.token_on_line();
  const std::optional<std::int64_t> count = parse_integer(word);
  if (!count || *count < 0) throw cursor.error("bad element count " + in_quotes(word));
  element.count = static_cast<std::uint64_t>(*count);
  return element;
}

PlyProperty read_property(TextCursor& cursor) {
  PlyProperty property;
  TextCursor ahead = cursor;
  if (ahead.token_on_line() == "list") {
    cursor = ahead;
    property.count_type = read_type(cursor);
    if (*property.count_type == PlyType::float32 || *property.count_type == PlyType::float64) {
      throw cursor.error("a list's count must be an integer type");
    }
  }
  property.type = read_type(cursor);
  property.name = cursor.token_on_line();
  if (property.name.empty()) throw cursor.error("the property has no name");
  return property;
}

// Parses the header. Throws Error{bad_input} naming the line.
PlyHeader parse_ply_header(std::string_view text, const std::string& path) {
  TextCursor cursor(path, text, '\0');
  if (cursor.token_on_line() != "ply") throw Error(ErrorKind::bad_input, path + ": not a PLY file");
  cursor.skip_line();

  PlyHeader header;
  bool has_format = false;
  while (!cursor.at_end()) {
    const std::string_view keyword = cursor.token_on_line();
    if (keyword == "end_header") {
      if (!has_format) throw cursor.error("the PLY header has no format line");
      cursor.skip_line();
      header.body_begin = text.size() - cursor.remaining();
      header.body_line = cursor.line();
      return header;
    }
    if (keyword == "format") {
      header.format = read_format(cursor);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(cursor));
    } else if (keyword == "property") {
      if (header.elements.empty()) throw cursor.error("the property stands before any element");
      header.elements.back().properties.push_back(read_property(cursor));
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      throw cursor.error("unknown word " + in_quotes(keyword) + " in the PLY header");
    }
    cursor.skip_line();
  }
  throw Error(ErrorKind::bad_input, path + ": the PLY header has no end (end_header is missing)");
}

// Reads scalars that follow each other as text. Throws EndOfData where the file ends.
class AsciiScalars {
 public:
  AsciiScalars(const std::string& path, std::string_view text, const PlyHeader& header)
      : cursor_(path, text.substr(header.body_begin), '\0'), first_line_(header.body_line) {}

  // Returns the next number. A float32 property becomes the float nearest to its decimal text.
  double next(PlyType type) {
    const std::string_view word = cursor_.token();
    if (word.empty()) throw EndOfData{};
    const std::optional<double> value =
        type == PlyType::float32 ? std::optional<double>(parse_float(word)) : parse_double(word);
    if (!value) throw BadWord{std::string(word)};
    return *value;
  }

  [[nodiscard]] std::uint64_t remaining() const { return cursor_.remaining(); }
  // Each entry of a list takes at least one character and a separator.
  [[nodiscard]] static std::uint64_t least_bytes(PlyType) { return 2; }
  [[nodiscard]] std::string place() const {
    return "line " + std::to_string(first_line_ + cursor_.line() - 1);
  }
  // Returns whether anything is left after the last element.
  bool has_more() { return cursor_.has_more(); }

  struct EndOfData {};
  struct BadWord {
    std::string word;
  };

 private:
  TextCursor cursor_;
  std::uint64_t first_line_;
};

// Reads scalars that follow each other as bytes. Throws EndOfData where the file ends.
class BinaryScalars {
 public:
  BinaryScalars(std::string_view text, const PlyHeader& header)
      : text_(text),
        at_(header.body_begin),
        swap_((header.format == PlyFormat::binary_big_endian) ==
              (std::endian::native == std::endian::little)) {}

  double next(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t, std::uint8_t>();
      case PlyType::uint8:
        return take<std::uint8_t, std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t, std::uint16_t>();
      case PlyType::uint16:
        return take<std::uint16_t, std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t, std::uint32_t>();
      case PlyType::uint32:
        return take<std::uint32_t, std::uint32_t>();
      case PlyType::float32:
        return static_cast<double>(take<float, std::uint32_t>());
      case PlyType::float64:
        break;
    }
    return take<double, std::uint64_t>();
  }

  [[nodiscard]] std::uint64_t remaining() const { return text_.size() - at_; }
  [[nodiscard]] static std::uint64_t least_bytes(PlyType type) { return byte_size(type); }
  [[nodiscard]] std::string place() const { return "byte " + std::to_string(at_); }
  [[nodiscard]] bool has_more() const { return at_ < text_.size(); }

 private:
  template <class Value, class Bits>
  Value take() {
    if (remaining() < sizeof(Bits)) throw AsciiScalars::EndOfData{};
    Bits bits = 0;
    std::memcpy(&bits, text_.data() + at_, sizeof(Bits));
    at_ += sizeof(Bits);
    if (swap_) bits = swapped(bits);
    return std::bit_cast<Value>(bits);
  }

  template <class Bits>
  static Bits swapped(Bits bits) {
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
      result = (result << 8U) | ((std::uint64_t{bits} >> (8 * i)) & 0xFFU);
    }
    return static_cast<Bits>(result);
  }

  std::string_view text_;
  std::size_t at_;
  bool swap_;
};

// Says which properties of a vertex are read.
struct VertexLayout {
  std::vector<int> slot;  // per property: 0..2 position, 3..5 normal, -1 skipped
  bool has_normals = false;
};

VertexLayout vertex_layout(const PlyElement& element, const std::string& path) {
  constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
  VertexLayout layout;
  layout.slot.assign(element.properties.size(), -1);
  std::array<bool, 6> found{};
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const PlyProperty& property = element.properties[p];
      if (found[i] || property.name != kNames[i] || property.count_type) continue;
      layout.slot[p] = static_cast<int>(i);
      found[i] = true;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (!found[i]) {
      throw Error(ErrorKind::bad_input, path + ": the vertices have no property " + std::string(kNames[i]));
    }
  }
  layout.has_normals = found[3] && found[4] && found[5];
  return layout;
}

// Returns the property that lists the corners of faces or strips, or properties.size() if there is none.
std::size_t index_list(const PlyElement& element) {
  std::size_t p = 0;
  for (; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    if (property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index")) break;
  }
  return p;
}

// Polygons or strips, one after the other. The file may store their vertices after them, so triangles are
// made at the end.
struct IndexLists {
  std::vector<std::int64_t> indices;
  std::vector<std::size_t> ends;
};

template <class Scalars>
class PlyBody {
 public:
  PlyBody(std::string path, const PlyHeader& header, Scalars scalars)
      : path_(std::move(path)), header_(header), scalars_(std::move(scalars)) {}

  Model read(const ReadOptions& options) {
    for (const PlyElement& element : header_.elements) read_element(element, options);
    if (!has_vertices_) throw Error(ErrorKind::bad_input, path_ + ": there is no element 'vertex'");

    Model model = start_model(path_, "ply");
    if (scalars_.has_more()) model.notes.emplace_back("data after the last element left out");
    add_polygons(model);
    add_strips();
    require_at_most(mesh_.triangles.size(), "triangles", path_, options);
    repair_normals(mesh_);
    Primitive primitive;
    primitive.name = file_stem(path_);
    primitive.mesh = std::move(mesh_);
    add_primitive(model, std::move(primitive));
    return model;
  }

 private:
  void read_element(const PlyElement& element, const ReadOptions& options) {
    const std::string what = element.name == "face"     ? "faces"
                             : element.name == "vertex" ? "vertices"
                                                        : "elements '" + element.name + "'";
    // An element without properties takes no bytes, so its count cannot be checked against the file size.
    if (element.properties.empty() && element.name != "vertex") return;
    const VertexLayout layout = element.name == "vertex" ? vertex_layout(element, path_) : VertexLayout{};
    require_fits(element.count, element.least_bytes(header_.format), scalars_.remaining(), what, path_);
    require_at_most(element.count, what, path_, options);

    std::uint64_t i = 0;
    try {
      if (element.name == "vertex") {
        start_vertices(element, layout);
        for (; i < element.count; ++i) read_vertex(element, layout);
      } else if (element.name == "face") {
        const std::size_t list = require_list(element);
        faces_.ends.reserve(element.count);
        for (; i < element.count; ++i) read_list(element, list, faces_);
      } else if (element.name == "tristrips") {
        const std::size_t list = require_list(element);
        for (; i < element.count; ++i) read_list(element, list, strips_);
      } else {
        for (; i < element.count; ++i) {
          for (const PlyProperty& property : element.properties) skip(property);
        }
      }
    } catch (const AsciiScalars::EndOfData&) {
      throw Error(ErrorKind::bad_input, path_ + ": " + name_of(element, i) +
                                            " is cut off (the file ends at " + scalars_.place() + ")");
    } catch (const AsciiScalars::BadWord& bad) {
      throw Error(ErrorKind::bad_input, path_ + ": " + scalars_.place() + ": " + name_of(element, i) +
                                            ": expected a number, found " + in_quotes(bad.word));
    }
  }

  static std::string name_of(const PlyElement& element, std::uint64_t i) {
    return element.name + " " + std::to_string(i + 1) + " of " + std::to_string(element.count);
  }

  void start_vertices(const PlyElement& element, const VertexLayout& layout) {
    if (has_vertices_) throw Error(ErrorKind::bad_input, path_ + ": there are two elements 'vertex'");
    has_vertices_ = true;
    mesh_.positions.reserve(element.count);
    if (layout.has_normals) mesh_.normals.reserve(element.count);
  }

  void read_vertex(const PlyElement& element, const VertexLayout& layout) {
    std::array<float, 6> values{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (layout.slot[p] < 0) {
        skip(element.properties[p]);
      } else {
        values[static_cast<std::size_t>(layout.slot[p])] =
            static_cast<float>(scalars_.next(element.properties[p].type));
      }
    }
    mesh_.positions.push_back({values[0], values[1], values[2]});
    if (layout.has_normals) mesh_.normals.push_back({values[3], values[4], values[5]});
  }

  std::size_t require_list(const PlyElement& element) const {
    const std::size_t list = index_list(element);
    if (list == element.properties.size()) {
      throw Error(ErrorKind::bad_input,
                  path_ + ": the element '" + element.name + "' has no list vertex_indices or vertex_index");
    }
    return list;
  }

  // Reads the length of a list. Throws EndOfData if the rest of the file is shorter than the list.
  std::uint64_t list_length(const PlyProperty& property) {
    const double length = scalars_.next(*property.count_type);
    if (!(length >= 0) || length != std::floor(length)) {
      throw Error(ErrorKind::bad_input,
                  path_ + ": " + scalars_.place() + ": the length of the list is not a whole number");
    }
    const double room = static_cast<double>(scalars_.remaining() + 1) /
                        static_cast<double>(Scalars::least_bytes(property.type));
    if (length > room) throw AsciiScalars::EndOfData{};
    return static_cast<std::uint64_t>(length);
  }

  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.count_type ? list_length(property) : 1;
    for (std::uint64_t i = 0; i < count; ++i) scalars_.next(property.type);
  }

  void read_list(const PlyElement& element, std::size_t list, IndexLists& lists) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (p != list) {
        skip(element.properties[p]);
        continue;
      }
      const std::uint64_t count = list_length(element.properties[p]);
      for (std::uint64_t i = 0; i < count; ++i) {
        lists.indices.push_back(to_index(scalars_.next(element.properties[p].type)));
      }
    }
    lists.ends.push_back(lists.indices.size());
  }

  // Returns a number as an index. A number that cannot be an index becomes one that is out of range, which is
  // reported with its face.
  static std::int64_t to_index(double value) {
    constexpr double kFarOut = 9e15;  // beyond any uint32, exact in a double
    if (!(std::fabs(value) < kFarOut) || value != std::floor(value))
      return static_cast<std::int64_t>(kFarOut);
    return static_cast<std::int64_t>(value);
  }

  std::uint32_t require_vertex(std::int64_t index, const std::string& what, std::size_t i,
                               std::size_t count) const {
    if (index >= 0 && static_cast<std::uint64_t>(index) < mesh_.positions.size()) {
      return static_cast<std::uint32_t>(index);
    }
    throw Error(ErrorKind::bad_input, path_ + ": " + what + " " + std::to_string(i + 1) + " of " +
                                          std::to_string(count) + ": index " + std::to_string(index) +
                                          " is out of range (there are " +
                                          counted(mesh_.positions.size(), "position") + ")");
  }

  void add_polygons(Model& model) {
    std::vector<std::uint32_t> corners;
    std::uint64_t short_faces = 0;
    std::size_t begin = 0;
    mesh_.triangles.reserve(faces_.ends.size());
    for (std::size_t f = 0; f < faces_.ends.size(); ++f) {
      corners.clear();
      for (std::size_t i = begin; i < faces_.ends[f]; ++i) {
        corners.push_back(require_vertex(faces_.indices[i], "face", f, faces_.ends.size()));
      }
      begin = faces_.ends[f];
      if (corners.size() < 3) ++short_faces;
      triangulate(corners, mesh_.positions, mesh_.triangles);
    }
    note_short_faces(short_faces, model);
  }

  // Adds the triangles of strips. A negative index ends a strip. Every second triangle has the opposite
  // winding.
  void add_strips() {
    std::size_t begin = 0;
    for (std::size_t s = 0; s < strips_.ends.size(); ++s) {
      std::size_t strip_begin = begin;
      for (std::size_t i = begin; i < strips_.ends[s]; ++i) {
        if (strips_.indices[i] < 0) {
          strip_begin = i + 1;
        } else {
          require_vertex(strips_.indices[i], "strip", s, strips_.ends.size());
          if (i >= strip_begin + 2) add_strip_triangle(i - 2, (i - strip_begin) % 2 == 1);
        }
      }
      begin = strips_.ends[s];
    }
  }

  void add_strip_triangle(std::size_t first, bool turned) {
    const auto vertex = [&](std::size_t i) { return static_cast<std::uint32_t>(strips_.indices[i]); };
    const Triangle t{vertex(first), vertex(first + (turned ? 2 : 1)), vertex(first + (turned ? 1 : 2))};
    // Strips are stitched together with triangles that have two equal corners.
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh_.triangles.push_back(t);
  }

  std::string path_;
  const PlyHeader& header_;
  Scalars scalars_;
  bool has_vertices_ = false;
  Mesh mesh_;
  IndexLists faces_, strips_;
};

Model read_ply(const std::string& path, const ReadOptions& options) {
  const std::vector<std::byte> bytes = read_model_file(path);
  const std::string_view text = text_of(bytes);
  const PlyHeader header = parse_ply_header(text, path);
  if (header.format == PlyFormat::ascii) {
    return PlyBody(path, header, AsciiScalars(path, text, header)).read(options);
  }
  return PlyBody(path, header, BinaryScalars(text, header)).read(options);
}

bool begins_as_ply(std::string_view bytes) {
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

}  // namespace

FormatReader ply_reader() {
  return {"ply", {".ply"}, begins_as_ply, read_ply};
}

}  // namespace pellucid
