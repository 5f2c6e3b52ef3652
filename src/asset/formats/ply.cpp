// Reads PLY files: text and binary in both byte orders, polygons and triangle strips, any scalar types. Reads
// positions, normals, colours and texture coordinates of vertices, and texture coordinates of the corners of
// faces as MeshLab writes them. Skips other elements and properties. Format: Turk, "The PLY polygon file
// format", 1994.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asset/formats/foreign_model.h"
#include "asset/formats/ply_header.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

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

  // Passes over a number that nobody uses, whatever its text is.
  void skip(PlyType /*type*/) {
    if (cursor_.token().empty()) throw EndOfData{};
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

  void skip(PlyType type) {
    if (remaining() < byte_size(type)) throw AsciiScalars::EndOfData{};
    at_ += byte_size(type);
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
  // The numbers that a vertex can have, in this order, with the names that programs give them.
  static constexpr std::size_t kNormal = 3, kColor = 6, kAlpha = 9, kTexcoord = 10, kNumbers = 12;
  std::vector<int> slot;                   // per property: which of the numbers it is, -1: skipped
  std::array<float, kNumbers> per_unit{};  // of colours: the number that means 1
  bool has_normals = false, has_colors = false, has_texcoords = false;
};

bool is_name_of(std::size_t number, std::string_view name) {
  static const std::array<std::vector<std::string_view>, VertexLayout::kNumbers> kNames{
      {{"x"},
       {"y"},
       {"z"},
       {"nx", "normal_x"},
       {"ny", "normal_y"},
       {"nz", "normal_z"},
       {"red", "r", "diffuse_red"},
       {"green", "g", "diffuse_green"},
       {"blue", "b", "diffuse_blue"},
       {"alpha", "a", "diffuse_alpha"},
       {"s", "u", "texture_u"},
       {"t", "v", "texture_v"}}};
  return std::find(kNames.at(number).begin(), kNames.at(number).end(), name) != kNames.at(number).end();
}

// Colours of one or two bytes reach from 0 to the largest number of the type. For other types finish_colors()
// decides.
float unit_of(PlyType type) {
  if (byte_size(type) > 2) return 1;
  return static_cast<float>(std::pow(2.0, 8.0 * static_cast<double>(byte_size(type))) - 1);
}

VertexLayout vertex_layout(const PlyElement& element, const std::string& path) {
  constexpr std::array<std::string_view, 3> kCoordinates{"x", "y", "z"};
  VertexLayout layout;
  layout.slot.assign(element.properties.size(), -1);
  std::array<bool, VertexLayout::kNumbers> found{};
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    for (std::size_t i = 0; i < found.size(); ++i) {
      const PlyProperty& property = element.properties[p];
      if (found[i] || property.count_type || !is_name_of(i, property.name)) continue;
      layout.slot[p] = static_cast<int>(i);
      layout.per_unit[i] = unit_of(property.type);
      found[i] = true;
    }
  }
  for (std::size_t i = 0; i < kCoordinates.size(); ++i) {
    if (!found[i])
      throw Error(ErrorKind::bad_input,
                  path + ": the vertices have no property " + std::string(kCoordinates[i]));
  }
  const auto all = [&](std::size_t first, std::size_t count) {
    return std::all_of(found.begin() + static_cast<std::ptrdiff_t>(first),
                       found.begin() + static_cast<std::ptrdiff_t>(first + count), [](bool f) { return f; });
  };
  layout.has_normals = all(VertexLayout::kNormal, 3);
  layout.has_colors = all(VertexLayout::kColor, 3);
  layout.has_texcoords = all(VertexLayout::kTexcoord, 2);
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
  // Texture coordinates of the corners, two numbers for each; empty if some corner has none.
  std::vector<float> texcoords;
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
    give_corners_vertices(options);
    add_polygons(model);
    add_strips();
    require_at_most(mesh_.triangles.size(), "triangles", path_, options);
    repair_normals(mesh_);
    primitive_.mesh = std::move(mesh_);
    primitive_.name = file_stem(path_);
    set_texture(model);
    add_notes(model);
    finish_colors(primitive_.colors);
    set_alpha_mode(primitive_, false);
    add_primitive(model, std::move(primitive_));
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
        note_face_properties(element);
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
    std::array<float, VertexLayout::kNumbers> values{};
    values[VertexLayout::kAlpha] = -1;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (layout.slot[p] < 0) {
        skip(element.properties[p]);
      } else {
        const auto slot = static_cast<std::size_t>(layout.slot[p]);
        const auto value = static_cast<float>(scalars_.next(element.properties[p].type));
        values[slot] = slot >= VertexLayout::kColor && slot <= VertexLayout::kAlpha
                           ? value / layout.per_unit[slot]
                           : value;
      }
    }
    mesh_.positions.push_back({values[0], values[1], values[2]});
    if (layout.has_normals) mesh_.normals.push_back({values[3], values[4], values[5]});
    if (layout.has_colors) primitive_.colors.push_back({values[6], values[7], values[8], values[9]});
    if (layout.has_texcoords) primitive_.texcoords.push_back(texcoord(values[10], values[11]));
  }

  // glTF counts v downwards. A coordinate that is not finite cannot be written and becomes 0.
  static std::array<float, 2> texcoord(float u, float v) {
    return {std::isfinite(u) ? u : 0, std::isfinite(v) ? 1 - v : 0};
  }

  // Says which properties of faces are left out.
  void note_face_properties(const PlyElement& element) {
    for (const PlyProperty& property : element.properties) {
      face_colors_ = face_colors_ || property.name == "red" || property.name == "diffuse_red";
    }
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
    for (std::uint64_t i = 0; i < count; ++i) scalars_.skip(property.type);
  }

  void read_list(const PlyElement& element, std::size_t list, IndexLists& lists) {
    const std::size_t first_texcoord = lists.texcoords.size();
    bool complete = false;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (p != list && is_texcoord_list(element.properties[p])) {
        read_texcoords(element.properties[p], lists);
        complete = true;
        continue;
      }
      if (p != list && element.properties[p].name == "texnumber" && !element.properties[p].count_type) {
        other_textures_ = scalars_.next(element.properties[p].type) > 0 || other_textures_;
        continue;
      }
      if (p != list) {
        skip(element.properties[p]);
        continue;
      }
      const std::uint64_t count = list_length(element.properties[p]);
      for (std::uint64_t i = 0; i < count; ++i) {
        lists.indices.push_back(to_index(scalars_.next(element.properties[p].type)));
      }
    }
    const std::size_t corners = lists.indices.size() - (lists.ends.empty() ? 0 : lists.ends.back());
    lists.ends.push_back(lists.indices.size());
    // Faces may lack coordinates, or have another number of them.
    if (complete) lists.texcoords.resize(first_texcoord + 2 * corners, 0.0F);
  }

  static bool is_texcoord_list(const PlyProperty& property) {
    return property.count_type && property.name == "texcoord";
  }

  void read_texcoords(const PlyProperty& property, IndexLists& lists) {
    const std::uint64_t count = list_length(property);
    for (std::uint64_t i = 0; i < count; ++i)
      lists.texcoords.push_back(static_cast<float>(scalars_.next(property.type)));
  }

  // Where corners of faces have texture coordinates of their own, each combination of vertex and coordinates
  // becomes a vertex, numbered by first use. Strips, which would need the old numbers, do not occur beside
  // them.
  void give_corners_vertices(const ReadOptions& options) {
    if (faces_.texcoords.empty() || faces_.texcoords.size() != 2 * faces_.indices.size() ||
        !strips_.ends.empty())
      return;
    require_at_most(faces_.indices.size(), "face corners", path_, options);
    using Key = std::pair<std::int64_t, std::array<float, 2>>;
    std::map<Key, std::uint32_t> numbers;
    std::vector<std::int64_t> corners;
    Mesh mesh;
    Primitive primitive;
    for (std::size_t i = 0; i < faces_.indices.size(); ++i) {
      const std::int64_t old = faces_.indices[i];
      if (old < 0 || static_cast<std::uint64_t>(old) >= mesh_.positions.size()) return;  // reported later
      const std::array<float, 2> uv = texcoord(faces_.texcoords[2 * i], faces_.texcoords[2 * i + 1]);
      const auto [entry, is_new] =
          numbers.try_emplace({old, uv}, static_cast<std::uint32_t>(mesh.positions.size()));
      corners.push_back(entry->second);
      if (!is_new) continue;
      const auto from = static_cast<std::size_t>(old);
      mesh.positions.push_back(mesh_.positions[from]);
      if (!mesh_.normals.empty()) mesh.normals.push_back(mesh_.normals[from]);
      if (!primitive_.colors.empty()) primitive.colors.push_back(primitive_.colors[from]);
      primitive.texcoords.push_back(uv);
    }
    faces_.indices = std::move(corners);
    mesh_ = std::move(mesh);
    primitive_.colors = std::move(primitive.colors);
    primitive_.texcoords = std::move(primitive.texcoords);
  }

  void set_texture(Model& model) {
    if (header_.textures.empty()) return;
    const std::string& name = header_.textures.front();
    if (primitive_.texcoords.empty()) {
      model.notes.push_back("texture " + in_quotes(name) + " left out: there are no texture coordinates");
      return;
    }
    primitive_.texture = find_texture(model, "", name);
    other_textures_ = other_textures_ || header_.textures.size() > 1;
  }

  void add_notes(Model& model) const {
    if (face_colors_) model.notes.emplace_back("colours of faces left out");
    if (other_textures_) model.notes.emplace_back("of several textures only the first is used");
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
  Primitive primitive_;  // its attributes
  IndexLists faces_, strips_;
  bool face_colors_ = false, other_textures_ = false;
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
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

}  // namespace

FormatReader ply_reader() {
  return {"ply", {".ply"}, begins_as_ply, read_ply};
}

}  // namespace pellucid
