// Implements foreign_model.h: limits, names of files, colours, normals and notes. Polygons become triangles
// in triangulate.cpp.
#include "asset/formats/foreign_model.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <system_error>

#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

bool has_direction(const Vec3f& v) {
  const double size = length(to_double(v));
  return std::isfinite(size) && size > 0;
}

}  // namespace

std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string file_stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

Model start_model(const std::string& path, const std::string& format) {
  Model model;
  model.path = path;
  model.format = format;
  return model;
}

std::vector<std::byte> read_model_file(const std::string& path) {
  std::vector<std::byte> bytes = read_file(path);
  if (bytes.empty()) throw Error(ErrorKind::bad_input, path + ": the file is empty");
  return bytes;
}

void require_at_most(std::uint64_t count, const std::string& what, const std::string& path,
                     const ReadOptions& options) {
  const std::uint64_t limit =
      std::min<std::uint64_t>(options.max_elements, std::numeric_limits<std::uint32_t>::max());
  if (count <= limit) return;
  throw Error(ErrorKind::bad_input,
              path + ": " + std::to_string(count) + " " + what + "; the limit is " + std::to_string(limit));
}

void require_fits(std::uint64_t count, std::uint64_t least_bytes_each, std::uint64_t bytes_left,
                  const std::string& what, const std::string& path) {
  // The last line may have no line end.
  const std::uint64_t most = (bytes_left + 1) / std::max<std::uint64_t>(least_bytes_each, 1);
  if (count <= most) return;
  throw Error(ErrorKind::bad_input, path + ": the header declares " + std::to_string(count) + " " + what +
                                        ", but the file has room for at most " + std::to_string(most));
}

void repair_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  std::vector<Vec3f> substitutes;
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    Vec3f& normal = mesh.normals[v];
    if (!has_direction(normal)) {
      if (substitutes.empty()) substitutes = vertex_normals(mesh);
      normal = has_direction(substitutes[v]) ? substitutes[v] : Vec3f{0, 0, 1};
    }
    normal = to_float(normalized(to_double(normal)));
  }
}

std::string counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::array<float, 4> vertex_color(float red, float green, float blue, float alpha) {
  const auto unit = [](float x) { return x >= 0 ? std::min(double{x}, 1.0) : 0.0; };
  const auto linear = [&](float x) {
    const double encoded = unit(x);
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92
                                                 : std::pow((encoded + 0.055) / 1.055, 2.4));
  };
  return {linear(red), linear(green), linear(blue), static_cast<float>(unit(alpha))};
}

void finish_colors(std::vector<std::array<float, 4>>& colors) {
  float largest = 0;
  for (const auto& color : colors) largest = std::max({largest, color[0], color[1], color[2], color[3]});
  const float unit = largest > 1 ? 255.0F : 1.0F;
  for (auto& c : colors) {
    const bool none = c[0] < 0 && c[1] < 0 && c[2] < 0;
    if (none) c = {unit, unit, unit, c[3]};
    c = vertex_color(c[0] / unit, c[1] / unit, c[2] / unit, c[3] < 0 ? 1 : c[3] / unit);
  }
}

void set_alpha_mode(Primitive& primitive, bool states_opacity) {
  const bool translucent_vertices = std::any_of(primitive.colors.begin(), primitive.colors.end(),
                                                [](const auto& color) { return color[3] < 1; });
  primitive.has_material = states_opacity || translucent_vertices;
  const bool opaque = states_opacity && !translucent_vertices && primitive.base_color[3] >= 1;
  primitive.alpha_mode = opaque ? AlphaMode::opaque : AlphaMode::blend;
}

std::string find_beside(const std::string& model_path, std::string_view name) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(model_path).parent_path();
  const auto is_file = [](const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored);
  };
  std::string wanted(unquoted(name));
  if (wanted.empty()) return {};
  if (is_file(folder / wanted)) return (folder / wanted).string();
  std::replace(wanted.begin(), wanted.end(), '\\', '/');
  if (is_file(folder / wanted)) return (folder / wanted).string();
  // Another machine's absolute path, or another case: a file of that name beside the model.
  const std::string last = fs::path(wanted).filename().string();
  std::string found;
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, status)) {
    const std::string candidate = entry.path().filename().string();
    if (!equals_ignoring_case(candidate, last) || !is_file(entry.path())) continue;
    // The order of a folder's entries differs from machine to machine.
    if (found.empty() || candidate < found) found = candidate;
  }
  return found.empty() ? found : (folder / found).string();
}

std::vector<std::string> split_names(std::string_view names) {
  std::vector<std::string> result;
  std::string name;
  bool quoted = false, begun = false;
  for (const char c : names) {
    if (c == '"') {
      quoted = !quoted;
      begun = true;
    } else if (!quoted && (c == ' ' || c == '\t')) {
      if (begun) result.push_back(std::move(name));
      name.clear();
      begun = false;
    } else {
      name += c;
      begun = true;
    }
  }
  if (begun) result.push_back(std::move(name));
  return result;
}

void note_short_faces(std::uint64_t count, Model& model) {
  if (count > 0) model.notes.push_back(counted(count, "face") + " with fewer than 3 corners left out");
}

void add_primitive(Model& model, Primitive primitive) {
  const auto index = static_cast<std::uint32_t>(model.primitives.size());
  primitive.primitive_index = index;
  model.instances.push_back({primitive.name, index, {}});
  model.primitives.push_back(std::move(primitive));
}

}  // namespace pellucid
