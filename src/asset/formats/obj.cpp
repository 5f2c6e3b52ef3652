// Reads OBJ files (Wavefront): polygons with positions and normals, one primitive per material. Colours and
// opacities of materials come from the MTL files beside the model. Leaves out texture coordinates, lines,
// points and free-form surfaces.
#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kLargestMaterialFile = std::uint64_t{64} << 20U;
constexpr std::size_t kMostMaterialFiles = 64;
constexpr std::size_t kMostMaterials = 65536;

struct Corner {
  std::uint32_t position = kNone;
  std::uint32_t normal = kNone;
};

// The content of the file. Faces become triangles later, because they may name vertices that follow them.
struct ObjFile {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Corner> corners;
  struct Face {
    std::size_t corners_end = 0;
    std::uint32_t material = 0;  // index into material_names
  };
  std::vector<Face> faces;
  std::vector<std::string> material_names;  // in order of first use
  std::vector<std::string> libraries;
  std::set<std::string, std::less<>> objects;
  std::uint64_t short_faces = 0;
  std::uint64_t lines_and_points = 0;
  std::uint64_t free_form = 0;
};

class ObjParser {
 public:
  ObjParser(const std::string& path, std::string_view text) : path_(path), cursor_(path, text, '#') {}

  ObjFile parse() {
    while (!cursor_.at_end()) {
      read_statement(cursor_.token_on_line());
      cursor_.skip_line();
    }
    require_in_range(highest_position_, file_.positions.size(), "position");
    require_in_range(highest_normal_, file_.normals.size(), "normal");
    if (file_.positions.empty()) {
      throw Error(ErrorKind::bad_input, path_ + ": not an OBJ file, or one without vertices");
    }
    return std::move(file_);
  }

 private:
  // The greatest index of any face, and the line that contains it.
  struct Highest {
    std::uint64_t index = 0;
    std::uint64_t line = 0;
    bool used = false;
  };

  void read_statement(std::string_view keyword) {
    if (keyword == "v") {
      file_.positions.push_back(read_vector("a coordinate"));
    } else if (keyword == "vn") {
      file_.normals.push_back(read_vector("a normal's coordinate"));
    } else if (keyword == "f" || keyword == "fo") {
      read_face();
    } else if (keyword == "usemtl") {
      material_name_ = cursor_.rest_of_line();
      material_ = kNone;
    } else if (keyword == "mtllib") {
      file_.libraries.emplace_back(cursor_.rest_of_line());
    } else if (keyword == "o") {
      file_.objects.emplace(cursor_.rest_of_line());
    } else if (keyword == "l" || keyword == "p") {
      ++file_.lines_and_points;
    } else if (keyword == "surf" || keyword == "curv" || keyword == "curv2") {
      ++file_.free_form;
    }
  }

  float read_number(std::string_view what) {
    const std::string_view word = cursor_.token_on_line();
    if (const std::optional<float> value = parse_float(word)) return *value;
    if (word.empty()) throw cursor_.error("the line ends where " + std::string(what) + " should be");
    throw cursor_.unexpected(what, word);
  }

  Vec3f read_vector(std::string_view what) {
    const float x = read_number(what);
    const float y = read_number(what);
    return {x, y, read_number(what)};
  }

  // Returns the number of the current material. Only materials that some face uses get a number.
  std::uint32_t current_material() {
    if (material_ != kNone) return material_;
    const auto [entry, is_new] =
        material_index_.try_emplace(material_name_, static_cast<std::uint32_t>(file_.material_names.size()));
    if (is_new) file_.material_names.push_back(material_name_);
    if (file_.material_names.size() > kMostMaterials) {
      throw cursor_.error("more than " + std::to_string(kMostMaterials) + " materials");
    }
    return material_ = entry->second;
  }

  void read_face() {
    const std::size_t begin = file_.corners.size();
    for (std::string_view word = cursor_.token_on_line(); !word.empty(); word = cursor_.token_on_line()) {
      file_.corners.push_back(parse_corner(word));
    }
    if (file_.corners.size() - begin < 3) {
      file_.corners.resize(begin);
      ++file_.short_faces;
    } else {
      file_.faces.push_back({file_.corners.size(), current_material()});
    }
  }

  // Parses "v", "v/t", "v//n" or "v/t/n".
  Corner parse_corner(std::string_view word) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    Corner corner;
    corner.position = parse_index(word.substr(0, slash), word, file_.positions.size(), highest_position_);
    if (slash == word.size()) return corner;
    const std::size_t second = word.find('/', slash + 1);
    if (second == std::string_view::npos || second + 1 == word.size()) return corner;
    corner.normal = parse_index(word.substr(second + 1), word, file_.normals.size(), highest_normal_);
    return corner;
  }

  // Indices count from 1, or, where they are negative, back from the latest vertex.
  std::uint32_t parse_index(std::string_view text, std::string_view word, std::size_t count,
                            Highest& highest) {
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value) throw cursor_.error("expected a face's corner, found " + in_quotes(word));
    if (*value == 0) throw cursor_.error("index 0 in " + in_quotes(word) + ": indices begin at 1");
    const std::int64_t index = *value > 0 ? *value - 1 : static_cast<std::int64_t>(count) + *value;
    if (index < 0 || index >= std::int64_t{kNone}) {
      throw cursor_.error("index " + std::to_string(*value) + " in " + in_quotes(word) + " is out of range");
    }
    const auto result = static_cast<std::uint32_t>(index);
    if (!highest.used || result > highest.index) highest = {result, cursor_.line(), true};
    return result;
  }

  void require_in_range(const Highest& highest, std::size_t count, const std::string& noun) const {
    if (!highest.used || highest.index < count) return;
    throw Error(ErrorKind::bad_input, path_ + ": line " + std::to_string(highest.line) + ": index " +
                                          std::to_string(highest.index + 1) + " is out of range (there are " +
                                          counted(count, noun) + ")");
  }

  std::string path_;
  TextCursor cursor_;
  ObjFile file_;
  std::map<std::string, std::uint32_t> material_index_;
  std::string material_name_;
  std::uint32_t material_ = kNone;  // its number, as soon as a face uses it
  Highest highest_position_, highest_normal_;
};

// Builds the mesh of one material. Each pair of position and normal becomes a vertex, numbered by first use.
class PrimitiveBuilder {
 public:
  explicit PrimitiveBuilder(const ObjFile& file) : file_(file) {}

  void add_face(std::span<const Corner> corners) {
    positions_of_face_.clear();
    for (const Corner& corner : corners) positions_of_face_.push_back(vertex(corner));
    triangulate(positions_of_face_, mesh_.positions, mesh_.triangles);
  }

  // A primitive without normals that uses the whole file keeps the file's own vertex numbers.
  Mesh finish(bool whole_file) {
    if (!has_normals_) {
      mesh_.normals.clear();
      if (whole_file) restore_vertex_numbers();
    }
    repair_normals(mesh_);
    return std::move(mesh_);
  }

 private:
  std::uint32_t vertex(const Corner& corner) {
    const std::uint64_t key = (std::uint64_t{corner.position} << 32U) | corner.normal;
    const auto [entry, is_new] =
        vertices_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      has_normals_ = has_normals_ || corner.normal != kNone;
      mesh_.positions.push_back(file_.positions[corner.position]);
      mesh_.normals.push_back(corner.normal == kNone ? Vec3f{} : file_.normals[corner.normal]);
      source_.push_back(corner.position);
    }
    return entry->second;
  }

  void restore_vertex_numbers() {
    for (Triangle& t : mesh_.triangles) {
      for (std::uint32_t& v : t) v = source_[v];
    }
    mesh_.positions = file_.positions;
  }

  const ObjFile& file_;
  Mesh mesh_;
  std::vector<std::uint32_t> source_;  // vertex -> position in the file
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_;
  std::vector<std::uint32_t> positions_of_face_;
  bool has_normals_ = false;
};

// Reads one MTL file beside the model. Does not touch devices and pipes. Returns false if the file cannot be
// read.
bool read_library(const std::filesystem::path& path, ObjMaterials& materials) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) return false;
  try {
    parse_obj_materials(text_of(read_file(path.string(), kLargestMaterialFile)), materials);
  } catch (const Error&) {
    return false;
  }
  return true;
}

// Reads all material files. The rest of an mtllib line is one name with blanks, or several names.
ObjMaterials read_libraries(const ObjFile& file, Model& model) {
  const std::filesystem::path folder = std::filesystem::path(model.path).parent_path();
  ObjMaterials materials;
  std::set<std::string> seen;
  for (const std::string& names : file.libraries) {
    if (seen.size() >= kMostMaterialFiles) break;
    if (!seen.insert(names).second || read_library(folder / names, materials)) continue;
    TextCursor words("", names, '\0');
    while (words.has_more() && seen.size() < kMostMaterialFiles) {
      const std::string name(words.token());
      if (name != names && !seen.insert(name).second) continue;
      if (name == names || !read_library(folder / name, materials)) {
        model.notes.push_back("material file " + in_quotes(name) +
                              " cannot be read; default colours are used");
      }
    }
  }
  return materials;
}

void add_notes(const ObjFile& file, Model& model) {
  note_short_faces(file.short_faces, model);
  if (file.lines_and_points > 0) {
    model.notes.push_back(counted(file.lines_and_points, "line or point statement") + " left out");
  }
  if (file.free_form > 0)
    model.notes.push_back(counted(file.free_form, "free-form curve or surface") + " left out");
}

void add_primitives(const ObjFile& file, const ObjMaterials& materials, Model& model) {
  std::vector<PrimitiveBuilder> builders(file.material_names.size(), PrimitiveBuilder(file));
  std::size_t begin = 0;
  for (const ObjFile::Face& face : file.faces) {
    builders[face.material].add_face(std::span(file.corners).subspan(begin, face.corners_end - begin));
    begin = face.corners_end;
  }

  const std::string name = file.objects.size() == 1 && !file.objects.begin()->empty() ? *file.objects.begin()
                                                                                      : file_stem(model.path);
  for (std::size_t m = 0; m < builders.size(); ++m) {
    Primitive primitive;
    primitive.mesh = builders[m].finish(builders.size() == 1);
    if (primitive.mesh.triangles.empty()) continue;
    primitive.name = name;
    primitive.material_name = file.material_names[m];
    const auto material = materials.find(primitive.material_name);
    primitive.has_material = material != materials.end();
    if (primitive.has_material) primitive.base_color = material->second.base_color;
    add_primitive(model, std::move(primitive));
  }
  if (model.primitives.empty()) {
    Primitive points;
    points.name = name;
    points.mesh.positions = file.positions;
    add_primitive(model, std::move(points));
  }
  if (model.primitives.size() == 1) return;
  for (Primitive& primitive : model.primitives) {
    primitive.name += '#';
    primitive.name += std::to_string(primitive.primitive_index);
    model.instances[primitive.primitive_index].node_name = primitive.name;
  }
}

// Reads the next number of the line, if there is one, and clamps it to 0..1.
std::optional<float> unit_number(TextCursor& cursor) {
  const std::optional<float> value = parse_float(cursor.token_on_line());
  if (!value || !(*value == *value)) return {};
  return std::clamp(*value, 0.0F, 1.0F);
}

// Reads "Kd r g b", or one number for all three.
void read_diffuse(TextCursor& cursor, ObjMaterial& material) {
  const std::optional<float> red = unit_number(cursor);
  if (!red) return;
  const float green = unit_number(cursor).value_or(*red);
  const float blue = unit_number(cursor).value_or(*red);
  material.base_color = {*red, green, blue, material.base_color[3]};
}

// Reads "d 0.5" or "d -halo 0.5".
void read_dissolve(TextCursor& cursor, ObjMaterial& material, bool& has_dissolve) {
  TextCursor ahead = cursor;
  if (ahead.token_on_line() == "-halo") cursor = ahead;
  const std::optional<float> opacity = unit_number(cursor);
  if (!opacity) return;
  material.base_color[3] = *opacity;
  has_dissolve = true;
}

void read_transparency(TextCursor& cursor, ObjMaterial& material, bool has_dissolve) {
  const std::optional<float> transparency = unit_number(cursor);
  if (transparency && !has_dissolve && *transparency < 1.0F) material.base_color[3] = 1.0F - *transparency;
}

Model read_obj(const std::string& path, const ReadOptions& options) {
  const std::vector<std::byte> bytes = read_model_file(path);
  const ObjFile file = ObjParser(path, text_of(bytes)).parse();
  require_at_most(file.positions.size(), "vertices", path, options);
  require_at_most(file.corners.size(), "face corners", path, options);

  Model model = start_model(path, "obj");
  add_primitives(file, read_libraries(file, model), model);
  add_notes(file, model);
  return model;
}

}  // namespace

void parse_obj_materials(std::string_view text, ObjMaterials& materials) {
  TextCursor cursor("", text, '#');
  ObjMaterial* material = nullptr;
  bool has_dissolve = false;
  while (!cursor.at_end()) {
    const std::string_view keyword = cursor.token_on_line();
    if (keyword == "newmtl") {
      material = &(materials[std::string(cursor.rest_of_line())] = {});
      has_dissolve = false;
    } else if (material != nullptr) {
      if (keyword == "Kd") read_diffuse(cursor, *material);
      if (keyword == "d") read_dissolve(cursor, *material, has_dissolve);
      if (keyword == "Tr") read_transparency(cursor, *material, has_dissolve);
    }
    cursor.skip_line();
  }
}

FormatReader obj_reader() {
  return {"obj", {".obj"}, nullptr, read_obj};
}

}  // namespace pellucid
