// Reads OFF files (Geomview's object file format) as text: OFF, COFF, NOFF, STOFF and their combinations,
// with polygons and comments. Colours of faces are left out.
#include <array>
#include <cmath>
#include <optional>

#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

struct OffHeader {
  bool normals = false, colors = false, texcoords = false;
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

std::uint64_t parse_count(const TextCursor& cursor, std::string_view word, std::string_view what) {
  const std::optional<std::int64_t> count = parse_integer(word);
  if (!count) throw cursor.unexpected(what, word);
  if (*count < 0) throw cursor.error(std::string(what) + " is negative");
  return static_cast<std::uint64_t>(*count);
}

// Reads the keyword [ST][C][N]OFF and the numbers of vertices, faces and (unused, often missing) edges. The
// keyword is optional, and a well-known data set has no blank after it: "OFF490 518 0".
OffHeader read_header(TextCursor& cursor, const std::string& path) {
  OffHeader header;
  std::string_view word = cursor.token();
  const std::size_t off = word.find("OFF");
  if (off != std::string_view::npos) {
    std::string_view prefix = word.substr(0, off);
    if (prefix.find_first_of("4n") != std::string_view::npos) {
      throw cursor.error("OFF files with more than three dimensions are not supported");
    }
    const auto take = [&](std::string_view letters) {
      const bool there = prefix.starts_with(letters);
      if (there) prefix.remove_prefix(letters.size());
      return there;
    };
    header.texcoords = take("ST");
    header.colors = take("C");
    if (prefix.starts_with("N")) {
      header.normals = true;
      prefix.remove_prefix(1);
    }
    if (!prefix.empty()) throw Error(ErrorKind::bad_input, path + ": not an OFF file");
    word.remove_prefix(off + 3);
    if (word.empty()) word = cursor.token();
    if (word == "BINARY") throw cursor.error("binary OFF files are not supported; convert to PLY");
  } else if (!parse_integer(word)) {
    throw Error(ErrorKind::bad_input, path + ": not an OFF file");
  }
  header.vertices = parse_count(cursor, word, "the number of vertices");
  header.faces = parse_count(cursor, cursor.token(), "the number of faces");
  cursor.skip_line();
  return header;
}

Error cut_off(const std::string& path, const std::string& what, std::uint64_t i, std::uint64_t count) {
  return {ErrorKind::bad_input, path + ": " + what + " " + std::to_string(i + 1) + " of " +
                                    std::to_string(count) + " is cut off (the file ends)"};
}

Vec3f read_vector(TextCursor& cursor, std::string_view what) {
  const float x = cursor.read_float(what);
  const float y = cursor.read_float(what);
  return {x, y, cursor.read_float(what)};
}

// Reads what follows the position and normal of a vertex: a colour of three or four numbers, and texture
// coordinates. Numbers that are missing leave the defaults.
void read_attributes(TextCursor& cursor, const OffHeader& header, Primitive& primitive) {
  constexpr std::size_t kMost = 6;
  std::array<float, kMost> numbers{};
  std::size_t count = 0;
  while (count < kMost) {
    const std::optional<float> number = parse_float(cursor.token_on_line());
    if (!number) break;
    numbers[count++] = std::isfinite(*number) ? *number : 0;
  }
  const std::size_t of_texcoord = header.texcoords && count >= 2 ? 2 : 0;
  if (header.colors) {
    const std::size_t channels = count - of_texcoord;
    primitive.colors.push_back({numbers[0], numbers[1], numbers[2], channels >= 4 ? numbers[3] : -1});
  }
  if (header.texcoords) {
    if (of_texcoord == 0) count = 2;
    // glTF counts v downwards.
    primitive.texcoords.push_back({numbers[count - 2], 1 - numbers[count - 1]});
  }
}

// Reads the vertices.
void read_vertices(TextCursor& cursor, const OffHeader& header, const std::string& path,
                   Primitive& primitive) {
  Mesh& mesh = primitive.mesh;
  mesh.positions.reserve(header.vertices);
  if (header.normals) mesh.normals.reserve(header.vertices);
  for (std::uint64_t i = 0; i < header.vertices; ++i) {
    if (!cursor.has_more()) throw cut_off(path, "vertex", i, header.vertices);
    mesh.positions.push_back(read_vector(cursor, "a coordinate"));
    if (header.normals) mesh.normals.push_back(read_vector(cursor, "a normal's coordinate"));
    read_attributes(cursor, header, primitive);
    cursor.skip_line();
  }
  finish_colors(primitive.colors);
}

// Reads the faces. The colour of a face fills the rest of its line and is left out, with a note.
void read_faces(TextCursor& cursor, const OffHeader& header, Model& model, Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  std::uint64_t short_faces = 0;
  bool has_colors = false;
  for (std::uint64_t f = 0; f < header.faces; ++f) {
    if (!cursor.has_more()) throw cut_off(model.path, "face", f, header.faces);
    const std::uint64_t size = parse_count(cursor, cursor.token(), "the number of corners");
    require_fits(size, 2, cursor.remaining(), "corners of face " + std::to_string(f + 1), model.path);
    corners.clear();
    for (std::uint64_t i = 0; i < size; ++i) {
      const std::int64_t index = cursor.read_integer("a vertex index");
      if (index < 0 || static_cast<std::uint64_t>(index) >= mesh.positions.size()) {
        throw cursor.error("face " + std::to_string(f + 1) + " of " + std::to_string(header.faces) +
                           ": index " + std::to_string(index) + " is out of range (there are " +
                           counted(mesh.positions.size(), "position") + ")");
      }
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    if (corners.size() < 3) ++short_faces;
    triangulate(corners, mesh.positions, mesh.triangles);
    has_colors = has_colors || !cursor.token_on_line().empty();
    cursor.skip_line();
  }
  if (has_colors) model.notes.emplace_back("colours of faces left out");
  note_short_faces(short_faces, model);
}

Model read_off(const std::string& path, const ReadOptions& options) {
  const std::vector<std::byte> bytes = read_model_file(path);
  TextCursor cursor(path, text_of(bytes), '#');
  const OffHeader header = read_header(cursor, path);
  // "0 0 0\n" and "0\n" are the shortest lines.
  require_fits(header.vertices, 6, cursor.remaining(), "vertices", path);
  require_fits(header.faces, 2, cursor.remaining(), "faces", path);
  require_at_most(header.vertices, "vertices", path, options);
  require_at_most(header.faces, "faces", path, options);

  Model model = start_model(path, "off");
  Primitive primitive;
  primitive.name = file_stem(path);
  read_vertices(cursor, header, path, primitive);
  read_faces(cursor, header, model, primitive.mesh);
  require_at_most(primitive.mesh.triangles.size(), "triangles", path, options);
  if (cursor.has_more()) model.notes.emplace_back("text after the last face left out");
  repair_normals(primitive.mesh);
  set_alpha_mode(primitive, false);
  add_primitive(model, std::move(primitive));
  return model;
}

}  // namespace

FormatReader off_reader() {
  return {"off", {".off"}, nullptr, read_off};
}

}  // namespace pellucid
