// Reads OBJ files (Wavefront): polygons with positions, normals, texture coordinates and vertex colours, one
// primitive per material. Colours, opacities and textures of materials come from the MTL files beside the
// model (mtl.cpp). Leaves out lines, points and free-form surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>

#include "asset/formats/foreign_model.h"
#include "asset/formats/reader.h"
#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kLargestMaterialFile = std::uint64_t{64} << 20U;
constexpr std::array<float, 4> kNoColor{-1, -1, -1, -1};  // see finish_colors()
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kMostMaterialFiles = 64;
constexpr std::size_t kMostMaterials = 65536;

struct Corner {
  std::uint32_t position = kNone;
  std::uint32_t texcoord = kNone;
  std::uint32_t normal = kNone;

  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& corner) const {
    std::uint64_t hash = corner.position;
    for (const std::uint32_t index : {corner.texcoord, corner.normal})
      hash = hash * 0x9E3779B97F4A7C15ULL + index;
    return static_cast<std::size_t>(hash ^ (hash >> 32U));
  }
};

// The content of the file. Faces become triangles later, because they may name vertices that follow them.
struct ObjFile {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<std::array<float, 2>> texcoords;  // v runs upwards
  std::vector<std::array<float, 4>> colors;     // as many as positions, or fewer if the last ones have none
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
    require_in_range(highest_texcoord_, file_.texcoords.size(), "texture coordinate");
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
      read_color();
    } else if (keyword == "vn") {
      const float x = number_or_nan();
      const float y = number_or_nan();
      file_.normals.push_back({x, y, number_or_nan()});
    } else if (keyword == "vt") {
      const float u = number_or_nan();
      file_.texcoords.push_back({u, number_or_nan()});
    } else if (keyword == "f" || keyword == "fo") {
      read_face();
    } else if (keyword == "usemtl") {
      material_name_ = unquoted(cursor_.rest_of_line());
      material_ = kNone;
    } else if (keyword == "mtllib") {
      file_.libraries.emplace_back(cursor_.rest_of_line());
    } else if (keyword == "o") {
      file_.objects.emplace(unquoted(cursor_.rest_of_line()));
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

  // Returns a number that is not needed to draw something; NaN if there is none. Normals that are NaN are
  // replaced later.
  float number_or_nan() { return parse_float(cursor_.token_on_line()).value_or(kNaN); }

  // Reads what may follow a position: a weight, a colour, or a colour and an opacity.
  void read_color() {
    std::array<float, 4> numbers{};
    std::size_t count = 0;
    for (; count < numbers.size(); ++count) {
      const std::optional<float> number = parse_float(cursor_.token_on_line());
      if (!number) break;
      numbers[count] = *number;
    }
    if (count < 3) return;
    file_.colors.resize(file_.positions.size(), kNoColor);
    file_.colors.back() = {numbers[0], numbers[1], numbers[2], count == 4 ? numbers[3] : -1};
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
    const std::size_t second = std::min(word.find('/', slash + 1), word.size());
    const std::string_view texcoord = word.substr(slash + 1, second - slash - 1);
    if (!texcoord.empty())
      corner.texcoord = parse_index(texcoord, word, file_.texcoords.size(), highest_texcoord_);
    if (second + 1 < word.size())
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
  Highest highest_position_, highest_texcoord_, highest_normal_;
};

// Builds the primitive of one material. Each combination of position, texture coordinate and normal becomes a
// vertex, numbered by first use.
class PrimitiveBuilder {
 public:
  explicit PrimitiveBuilder(const ObjFile& file) : file_(file) {}

  void add_face(std::span<const Corner> corners) {
    vertices_of_face_.clear();
    for (const Corner& corner : corners) vertices_of_face_.push_back(vertex(corner));
    triangulate(vertices_of_face_, primitive_.mesh.positions, primitive_.mesh.triangles);
  }

  // A primitive of positions alone that uses the whole file keeps the file's own vertex numbers.
  Primitive finish(bool whole_file) {
    if (!has_normals_) primitive_.mesh.normals.clear();
    if (!has_texcoords_) primitive_.texcoords.clear();
    if (whole_file && !has_normals_ && !has_texcoords_) restore_vertex_numbers();
    repair_normals(primitive_.mesh);
    return std::move(primitive_);
  }

 private:
  std::uint32_t vertex(const Corner& corner) {
    const auto [entry, is_new] =
        vertices_.try_emplace(corner, static_cast<std::uint32_t>(primitive_.mesh.positions.size()));
    if (is_new) {
      has_normals_ = has_normals_ || corner.normal != kNone;
      has_texcoords_ = has_texcoords_ || corner.texcoord != kNone;
      primitive_.mesh.positions.push_back(file_.positions[corner.position]);
      primitive_.mesh.normals.push_back(corner.normal == kNone ? Vec3f{} : file_.normals[corner.normal]);
      primitive_.texcoords.push_back(texcoord_of(corner));
      if (!file_.colors.empty()) primitive_.colors.push_back(file_.colors[corner.position]);
      source_.push_back(corner.position);
    }
    return entry->second;
  }

  // glTF counts v downwards. A coordinate that is not finite cannot be written and becomes 0.
  [[nodiscard]] std::array<float, 2> texcoord_of(const Corner& corner) const {
    if (corner.texcoord == kNone) return {};
    const auto [u, v] = file_.texcoords[corner.texcoord];
    return {std::isfinite(u) ? u : 0, std::isfinite(v) ? 1 - v : 0};
  }

  void restore_vertex_numbers() {
    for (Triangle& t : primitive_.mesh.triangles) {
      for (std::uint32_t& v : t) v = source_[v];
    }
    primitive_.mesh.positions = file_.positions;
    primitive_.colors = file_.colors;
  }

  const ObjFile& file_;
  Primitive primitive_;
  std::vector<std::uint32_t> source_;  // vertex -> position in the file
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;
  std::vector<std::uint32_t> vertices_of_face_;
  bool has_normals_ = false, has_texcoords_ = false;
};

// Reads one MTL file beside the model. Returns false if the file cannot be read.
bool read_library(const std::string& model_path, std::string_view name, ObjMaterials& materials) {
  const std::string path = find_beside(model_path, name);
  if (path.empty()) return false;
  try {
    parse_obj_materials(text_of(read_file(path, kLargestMaterialFile)), materials);
    for (auto& [material_name, material] : materials) {
      if (material.library.empty()) material.library = path;
    }
  } catch (const Error&) {
    return false;
  }
  return true;
}

// Reads all material files. The rest of an mtllib line is one name with blanks, or several names.
ObjMaterials read_libraries(const ObjFile& file, Model& model) {
  ObjMaterials materials;
  std::set<std::string> seen;
  for (const std::string& names : file.libraries) {
    if (seen.size() >= kMostMaterialFiles) break;
    if (!seen.insert(names).second || read_library(model.path, names, materials)) continue;
    for (const std::string& name : split_names(names)) {
      if (seen.size() >= kMostMaterialFiles) break;
      if (name != names && !seen.insert(name).second) continue;
      if (name == names || !read_library(model.path, name, materials)) {
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

// Finds the texture of a material, and notes what of it is left out.
void set_texture(const ObjMaterial& material, Primitive& primitive, Model& model) {
  const auto note = [&](const std::string& what) {
    model.notes.push_back("material " + in_quotes(primitive.material_name) + ": " + what);
  };
  const std::string& opacity = material.opacity_map;
  if (!opacity.empty() && opacity != material.texture)
    note("the opacity map " + in_quotes(opacity) + " is left out");
  if (material.texture.empty()) return;
  if (material.moves_texture) note("options that scale or move its texture are left out");
  if (primitive.texcoords.empty())
    return note("its texture is left out: the faces have no texture coordinates");
  primitive.texture = find_texture(model, "material " + in_quotes(primitive.material_name) + ": ",
                                   material.texture, material.library);
}

void note_missing_materials(const std::vector<std::string>& names, Model& model) {
  if (names.empty()) return;
  constexpr std::size_t kNamed = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) list += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kNamed) list += " and " + std::to_string(names.size() - kNamed) + " more";
  model.notes.push_back("no material file describes " + list + "; default colours are used");
}

void add_primitives(const ObjFile& file, const ObjMaterials& materials, Model& model) {
  std::vector<std::string> missing;
  std::vector<PrimitiveBuilder> builders(file.material_names.size(), PrimitiveBuilder(file));
  std::size_t begin = 0;
  for (const ObjFile::Face& face : file.faces) {
    builders[face.material].add_face(std::span(file.corners).subspan(begin, face.corners_end - begin));
    begin = face.corners_end;
  }

  const std::string name = file.objects.size() == 1 && !file.objects.begin()->empty() ? *file.objects.begin()
                                                                                      : file_stem(model.path);
  for (std::size_t m = 0; m < builders.size(); ++m) {
    Primitive primitive = builders[m].finish(builders.size() == 1);
    if (primitive.mesh.triangles.empty()) continue;
    primitive.name = name;
    primitive.material_name = file.material_names[m];
    const auto material = materials.find(primitive.material_name);
    const bool found = material != materials.end();
    if (found) {
      primitive.base_color = material->second.base_color;
      set_texture(material->second, primitive, model);
    } else if (!primitive.material_name.empty()) {
      missing.push_back(in_quotes(primitive.material_name));
    }
    set_alpha_mode(primitive, found);
    // An opacity map that is the texture itself is the texture's own opacity.
    if (found && !material->second.opacity_map.empty() && !primitive.texture.empty())
      primitive.alpha_mode = AlphaMode::blend;
    add_primitive(model, std::move(primitive));
  }
  note_missing_materials(missing, model);
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

Model read_obj(const std::string& path, const ReadOptions& options) {
  const std::vector<std::byte> bytes = read_model_file(path);
  ObjFile file = ObjParser(path, text_of(bytes)).parse();
  if (!file.colors.empty()) file.colors.resize(file.positions.size(), kNoColor);
  finish_colors(file.colors);
  require_at_most(file.positions.size(), "vertices", path, options);
  require_at_most(file.corners.size(), "face corners", path, options);

  Model model = start_model(path, "obj");
  add_primitives(file, read_libraries(file, model), model);
  add_notes(file, model);
  return model;
}

}  // namespace

FormatReader obj_reader() {
  return {"obj", {".obj"}, nullptr, read_obj};
}

}  // namespace pellucid
