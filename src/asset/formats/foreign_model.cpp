// Implements foreign_model.h: limits, polygons as triangles, normals and notes.
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

constexpr std::size_t kLargestEarClipping = 4096;

// Returns Newell's normal. It is as long as twice the polygon's area.
Vec3d polygon_normal(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions) {
  const Vec3d origin = to_double(positions[corners[0]]);
  Vec3d sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(to_double(positions[corners[i]]) - origin, to_double(positions[corners[i + 1]]) - origin);
  }
  return sum;
}

Vec3d corner_normal(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::span<const Vec3f> positions) {
  const Vec3d p = to_double(positions[a]);
  return cross(to_double(positions[b]) - p, to_double(positions[c]) - p);
}

void fan(std::span<const std::uint32_t> corners, std::vector<Triangle>& triangles) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    triangles.push_back({corners[0], corners[i], corners[i + 1]});
  }
}

void split_quad(std::span<const std::uint32_t> c, std::span<const Vec3f> positions,
                std::vector<Triangle>& triangles) {
  const double agree_02 =
      dot(corner_normal(c[0], c[1], c[2], positions), corner_normal(c[0], c[2], c[3], positions));
  const double agree_13 =
      dot(corner_normal(c[1], c[2], c[3], positions), corner_normal(c[1], c[3], c[0], positions));
  if (!(agree_02 > 0) && agree_13 > agree_02) {
    triangles.push_back({c[0], c[1], c[3]});
    triangles.push_back({c[1], c[2], c[3]});
  } else {
    fan(c, triangles);
  }
}

// Ear clipping (Meisters 1975) over a doubly linked ring of corners, seen along the polygon's normal.
class EarClipper {
 public:
  EarClipper(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions, const Vec3d& normal)
      : corners_(corners), next_(corners.size()), previous_(corners.size()), points_(corners.size()) {
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    project(positions, normal);
  }

  [[nodiscard]] bool convex() const {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (turn(previous_[i], i, next_[i]) < 0) return false;
    }
    return true;
  }

  void clip(std::vector<Triangle>& triangles) {
    std::size_t left = corners_.size();
    std::size_t at = 0;
    // A full round without an ear happens only for polygons that intersect themselves. Then any corner is
    // clipped. The same is done for a hostile polygon that has used up its tests.
    std::size_t fruitless = 0;
    std::size_t tests_left = 8 * left;
    while (left > 3) {
      if (fruitless < left && tests_left > 0 && !is_ear(at)) {
        at = next_[at];
        ++fruitless;
        --tests_left;
        continue;
      }
      triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
      remove(at);
      at = previous_[at];
      fruitless = 0;
      --left;
    }
    triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
  }

 private:
  struct Point {
    double x = 0, y = 0;
  };

  // Drops the axis along which the normal is longest, and swaps the others where that keeps left turns left.
  void project(std::span<const Vec3f> positions, const Vec3d& normal) {
    const Vec3d size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Vec3d p = to_double(positions[corners_[i]]);
      if (size.x >= size.y && size.x >= size.z) {
        points_[i] = normal.x > 0 ? Point{p.y, p.z} : Point{p.z, p.y};
      } else if (size.y >= size.z) {
        points_[i] = normal.y > 0 ? Point{p.z, p.x} : Point{p.x, p.z};
      } else {
        points_[i] = normal.z > 0 ? Point{p.x, p.y} : Point{p.y, p.x};
      }
    }
  }

  // Returns a value > 0 if a, b, c turn left.
  [[nodiscard]] double turn(std::size_t a, std::size_t b, std::size_t c) const {
    return (points_[b].x - points_[a].x) * (points_[c].y - points_[a].y) -
           (points_[b].y - points_[a].y) * (points_[c].x - points_[a].x);
  }

  [[nodiscard]] bool same_point(std::size_t a, std::size_t b) const {
    return points_[a].x == points_[b].x && points_[a].y == points_[b].y;
  }

  [[nodiscard]] bool is_ear(std::size_t b) const {
    const std::size_t a = previous_[b];
    const std::size_t c = next_[b];
    if (!(turn(a, b, c) > 0)) return false;
    for (std::size_t p = next_[c]; p != a; p = next_[p]) {
      const bool inside = turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
      // Corners at the same place as the ear's own corners (holes joined by a bridge) do not block it.
      if (inside && !same_point(p, a) && !same_point(p, b) && !same_point(p, c)) return false;
    }
    return true;
  }

  void remove(std::size_t i) {
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
  }

  std::span<const std::uint32_t> corners_;
  std::vector<std::size_t> next_, previous_;
  std::vector<Point> points_;
};

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

void triangulate(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions,
                 std::vector<Triangle>& triangles) {
  if (corners.size() == 4) {
    split_quad(corners, positions, triangles);
    return;
  }
  if (corners.size() > 4 && corners.size() <= kLargestEarClipping) {
    const Vec3d normal = polygon_normal(corners, positions);
    const double area = length(normal);
    if (area > 0 && std::isfinite(area)) {
      EarClipper clipper(corners, positions, normal);
      if (!clipper.convex()) {
        clipper.clip(triangles);
        return;
      }
    }
  }
  fan(corners, triangles);
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
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
  };
  return {linear(red), linear(green), linear(blue), static_cast<float>(unit(alpha))};
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
