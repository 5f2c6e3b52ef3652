// Posed scenes: see pose.h.
#include "pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <tuple>

#include "pellucid/scene.h"

namespace pellucid::cli {
namespace {

std::uint32_t find_clip(const PosableModel& posable, const std::string& path, const std::string& name) {
  const std::vector<AnimationClip>& clips = posable.clips();
  std::string names;
  for (std::uint32_t i = 0; i < clips.size(); ++i) {
    if (clips[i].name == name) return i;
    names.append(names.empty() ? "" : ", ").append(clips[i].name);
  }
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error == std::errc{} && end == name.data() + name.size() && number < clips.size()) return number;
  throw Error(ErrorKind::bad_argument, fmt::format("--animation: {} has no animation '{}'; there is {}", path,
                                                   name, names.empty() ? "none" : names));
}

// For every vertex the first one that is the same point of a smooth surface: of the same place and normal.
std::vector<std::uint32_t> smooth_points(const Mesh& mesh) {
  std::vector<std::uint32_t> points(mesh.positions.size());
  std::map<std::array<float, 6>, std::uint32_t> first;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    points[v] = v;
    if (mesh.normals.empty()) continue;
    const Vec3f& p = mesh.positions[v];
    const Vec3f& n = mesh.normals[v];
    points[v] = first.try_emplace({p.x, p.y, p.z, n.x, n.y, n.z}, v).first->second;
  }
  return points;
}

// The posed part as a mesh of its own.
Mesh posed_part(const Scene& scene, const SceneObject& object, const Mesh& local,
                std::span<const Vec3f> positions) {
  Mesh mesh;
  mesh.positions.assign(
      positions.begin() + object.first_vertex,
      positions.begin() + object.first_vertex + static_cast<std::ptrdiff_t>(local.positions.size()));
  for (std::size_t t = 0; t < local.triangles.size(); ++t) {
    Triangle triangle = scene.mesh.triangles[object.first_triangle + t];
    for (std::uint32_t& vertex : triangle) vertex -= object.first_vertex;
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

// Normals of the posed triangles, smooth where those of the file are.
void set_normals(const Mesh& local, Mesh posed, std::span<Vec3f> normals) {
  const std::vector<std::uint32_t> points = smooth_points(local);
  for (Triangle& triangle : posed.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = points[vertex];
  }
  const std::vector<Vec3f> smooth = vertex_normals(posed);
  for (std::size_t v = 0; v < points.size(); ++v) normals[v] = smooth[points[v]];
}

// Fronts are counter-clockwise where the joints of a skin have them, not the node.
void turn_as(const Triangle& drawn, const Triangle& in_file, const SceneObject& object, std::size_t count,
             Scene& scene) {
  const bool turned = drawn[1] - drawn[0] != in_file[1] - in_file[0];
  if (turned == object.mirrored) return;
  for (std::size_t t = 0; t < count; ++t) {
    Triangle& triangle = scene.mesh.triangles[object.first_triangle + t];
    std::swap(triangle[1], triangle[2]);
  }
}

}  // namespace

std::optional<std::uint32_t> pose_scene(const Model& model, const std::string& animation, double time,
                                        Scene& scene) {
  const PosableModel posable(model);
  std::vector<Vec3f> positions = posable.rest_pose();
  std::optional<std::uint32_t> clip;
  if (!animation.empty()) clip = find_clip(posable, model.path, animation);
  if (clip) posable.pose(*clip, time, positions);
  const std::vector<ModelPart>& parts = posable.parts();
  std::size_t next = 0;
  for (const SceneObject& object : scene.objects) {
    while (parts[next].instance != object.instance) ++next;
    const ModelPart& part = parts[next];
    const CleanPrimitive& primitive = scene.primitives[object.primitive];
    const auto count = static_cast<std::ptrdiff_t>(primitive.mesh.positions.size());
    const auto target = scene.mesh.positions.begin() + object.first_vertex;
    std::copy_n(positions.begin() + part.first_vertex, count, target);
    turn_as(posable.triangles()[part.first_triangle], model.primitives[object.primitive].mesh.triangles[0],
            object, primitive.mesh.triangles.size(), scene);
    set_normals(primitive.mesh, posed_part(scene, object, primitive.mesh, scene.mesh.positions),
                std::span(scene.mesh.normals).subspan(object.first_vertex, static_cast<std::size_t>(count)));
  }
  scene.sphere = bounding_sphere(scene.mesh);
  return clip;
}

}  // namespace pellucid::cli
