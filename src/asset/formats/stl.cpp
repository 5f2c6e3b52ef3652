// Reads STL files, text and binary. Corners with bit-equal positions become one vertex. Facet normals are
// left out, because they follow from the corners.
#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kCountEnd = kHeaderBytes + 4;
constexpr std::size_t kFacetBytes = 50;

std::uint32_t little_endian_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i > 0; --i) value = (value << 8U) | static_cast<unsigned char>(bytes[at + i - 1]);
  return value;
}

bool begins_with_solid(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const std::size_t first = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  return equals_ignoring_case(bytes.substr(first, 5), "solid");
}

bool looks_like_text(std::string_view bytes) {
  const std::string_view sample = bytes.substr(0, 1024);
  return std::all_of(sample.begin(), sample.end(), [](char c) {
    return c >= ' ' || c == '\n' || c == '\r' || c == '\t' || static_cast<unsigned char>(c) >= 0x80U;
  });
}

// Returns whether the file is binary. Binary files may begin with "solid", too, so the length that follows
// from the count is checked first.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kCountEnd &&
      bytes.size() == kCountEnd + kFacetBytes * std::uint64_t{little_endian_at(bytes, kHeaderBytes)}) {
    return true;
  }
  return !begins_with_solid(bytes) || !looks_like_text(bytes);
}

Mesh read_binary(std::string_view bytes, Model& model, const ReadOptions& options) {
  if (bytes.size() < kCountEnd || (looks_like_text(bytes) && !begins_with_solid(bytes))) {
    throw Error(ErrorKind::bad_input, model.path + ": not an STL file");
  }
  const std::uint64_t count = little_endian_at(bytes, kHeaderBytes);
  const std::uint64_t expected = kCountEnd + kFacetBytes * count;
  if (bytes.size() < expected) {
    throw Error(ErrorKind::bad_input, model.path + ": the header declares " + counted(count, "triangle") +
                                          " in " + std::to_string(expected) + " bytes, but the file has " +
                                          std::to_string(bytes.size()));
  }
  require_at_most(3 * count, "corners", model.path, options);
  if (bytes.size() > expected) model.notes.emplace_back("data after the last triangle left out");

  Mesh mesh;
  mesh.positions.reserve(3 * count);
  for (std::uint64_t i = 0; i < 3 * count; ++i) {
    // A facet: normal, three corners of three floats each, two bytes of attributes.
    const std::size_t at = kCountEnd + kFacetBytes * (i / 3) + 12 * (1 + i % 3);
    const auto coordinate = [&](std::size_t k) {
      return std::bit_cast<float>(little_endian_at(bytes, at + 4 * k));
    };
    mesh.positions.push_back({coordinate(0), coordinate(1), coordinate(2)});
  }
  for (std::uint32_t v = 0; v < mesh.positions.size(); v += 3) mesh.triangles.push_back({v, v + 1, v + 2});
  return mesh;
}

class AsciiStl {
 public:
  explicit AsciiStl(const std::string& path, std::string_view text) : cursor_(path, text, '\0') {}

  Mesh read() {
    while (cursor_.has_more()) read_solid();
    return std::move(mesh_);
  }
  // Returns the name of the first solid; it may be empty.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t short_facets() const { return short_facets_; }

 private:
  static bool begins_with(std::string_view word, std::string_view keyword) {
    return equals_ignoring_case(word.substr(0, keyword.size()), keyword);
  }

  // Reads a keyword of two words, or of one: "outer loop", "endloop" and "end loop". A name may be glued to
  // it.
  void expect(std::string_view first, std::string_view second, std::string_view word) {
    if (equals_ignoring_case(word, first)) {
      if (begins_with(cursor_.token(), second)) return;
    } else if (begins_with(word, first) && begins_with(word.substr(first.size()), second)) {
      return;
    }
    throw cursor_.unexpected("'" + std::string(first) + " " + std::string(second) + "'", word);
  }

  void read_solid() {
    std::string_view word = cursor_.token();
    if (!begins_with(word, "solid")) throw cursor_.unexpected("'solid'", word);
    const std::string_view name = cursor_.rest_of_line();
    if (name_.empty()) name_ = name;
    for (;;) {
      word = cursor_.token();
      if (begins_with(word, "facet")) {
        read_facet();
      } else if (begins_with(word, "end")) {
        expect("end", "solid", word);
        cursor_.rest_of_line();
        return;
      } else {
        throw cursor_.unexpected("'facet' or 'endsolid'", word);
      }
    }
  }

  // Skips the normal, which follows from the corners, whatever stands in its place.
  std::string_view after_normal() {
    for (;;) {
      const std::string_view word = cursor_.token();
      if (word.empty() || begins_with(word, "outer")) return word;
      if (begins_with(word, "vertex") || begins_with(word, "end")) return word;
    }
  }

  void read_facet() {
    expect("outer", "loop", after_normal());
    std::vector<std::uint32_t> corners;
    std::string_view word = cursor_.token();
    for (; equals_ignoring_case(word, "vertex"); word = cursor_.token()) {
      corners.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
      const float x = cursor_.read_float("a coordinate");
      const float y = cursor_.read_float("a coordinate");
      mesh_.positions.push_back({x, y, cursor_.read_float("a coordinate")});
    }
    if (!begins_with(word, "end")) throw cursor_.unexpected("'vertex' or 'endloop'", word);
    expect("end", "loop", word);
    expect("end", "facet", cursor_.token());
    if (corners.size() < 3) ++short_facets_;
    // Some programs write polygons with more than three corners.
    triangulate(corners, mesh_.positions, mesh_.triangles);
  }

  TextCursor cursor_;
  Mesh mesh_;
  std::string name_;
  std::uint64_t short_facets_ = 0;
};

// Makes one vertex of all corners with the same position. Vertices are numbered by first use.
void weld(Mesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  const std::vector<std::uint32_t> first = weld_by_position(mesh.positions);
  std::vector<std::uint32_t> new_index(mesh.positions.size(), kUnused);
  std::vector<Vec3f> positions;
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) {
      std::uint32_t& index = new_index[first[v]];
      if (index == kUnused) {
        index = static_cast<std::uint32_t>(positions.size());
        positions.push_back(mesh.positions[first[v]]);
      }
      v = index;
    }
  }
  mesh.positions = std::move(positions);
}

Model read_stl(const std::string& path, const ReadOptions& options) {
  const std::vector<std::byte> bytes = read_model_file(path);
  const std::string_view text = text_of(bytes);
  Model model = start_model(path, "stl");
  Primitive primitive;
  primitive.name = file_stem(path);
  if (is_binary(text)) {
    primitive.mesh = read_binary(text, model, options);
  } else {
    AsciiStl reader(path, text);
    primitive.mesh = reader.read();
    if (!reader.name().empty()) primitive.name = reader.name();
    note_short_faces(reader.short_facets(), model);
  }
  require_at_most(primitive.mesh.positions.size(), "corners", path, options);
  weld(primitive.mesh);
  add_primitive(model, std::move(primitive));
  return model;
}

}  // namespace

FormatReader stl_reader() {
  return {"stl", {".stl"}, nullptr, read_stl};
}

}  // namespace pellucid
