// Reads OFF files (Geomview's object file format) as text: OFF, COFF, NOFF, STOFF and their combinations,
// with polygons and comments.
#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

struct OffHeader {
  bool normals = false;
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
    if (prefix.starts_with("ST")) prefix.remove_prefix(2);
    if (prefix.starts_with("C")) prefix.remove_prefix(1);
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

// Reads the vertices. Colours and texture coordinates fill the rest of the line of a vertex and are skipped.
void read_vertices(TextCursor& cursor, const OffHeader& header, const std::string& path, Mesh& mesh) {
  mesh.positions.reserve(header.vertices);
  if (header.normals) mesh.normals.reserve(header.vertices);
  for (std::uint64_t i = 0; i < header.vertices; ++i) {
    if (!cursor.has_more()) throw cut_off(path, "vertex", i, header.vertices);
    mesh.positions.push_back(read_vector(cursor, "a coordinate"));
    if (header.normals) mesh.normals.push_back(read_vector(cursor, "a normal's coordinate"));
    cursor.skip_line();
  }
}

// Reads the faces. The colour of a face fills the rest of its line and is skipped.
void read_faces(TextCursor& cursor, const OffHeader& header, Model& model, Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  std::uint64_t short_faces = 0;
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
    cursor.skip_line();
  }
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
  read_vertices(cursor, header, path, primitive.mesh);
  read_faces(cursor, header, model, primitive.mesh);
  require_at_most(primitive.mesh.triangles.size(), "triangles", path, options);
  if (cursor.has_more()) model.notes.emplace_back("text after the last face left out");
  repair_normals(primitive.mesh);
  add_primitive(model, std::move(primitive));
  return model;
}

}  // namespace

FormatReader off_reader() {
  return {"off", {".off"}, nullptr, read_off};
}

}  // namespace pellucid
