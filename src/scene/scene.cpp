// Implements the scenes, poses and cameras of pellucid/scene.h: whole files as one mesh, at rest and in a
// pose, and the cameras of files.
#include "pellucid/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "pellucid/asset.h"
#include "pellucid/baseline.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

Vec3d transformed_point(const Mat4& a, const Vec3d& p) {
  return {a.m[0] * p.x + a.m[4] * p.y + a.m[8] * p.z + a.m[12],
          a.m[1] * p.x + a.m[5] * p.y + a.m[9] * p.z + a.m[13],
          a.m[2] * p.x + a.m[6] * p.y + a.m[10] * p.z + a.m[14]};
}

Vec3d transformed_direction(const Mat4& a, const Vec3d& d) {
  return transformed_point(a, d) - Vec3d{a.m[12], a.m[13], a.m[14]};
}

double determinant(const Mat4& a) {
  return dot(Vec3d{a.m[0], a.m[1], a.m[2]},
             cross(Vec3d{a.m[4], a.m[5], a.m[6]}, Vec3d{a.m[8], a.m[9], a.m[10]}));
}

// Returns the inverse of an affine matrix with determinant `d`.
Mat4 inverse(const Mat4& a, double d) {
  const Vec3d x{a.m[0], a.m[1], a.m[2]};
  const Vec3d y{a.m[4], a.m[5], a.m[6]};
  const Vec3d z{a.m[8], a.m[9], a.m[10]};
  const Vec3d t{a.m[12], a.m[13], a.m[14]};
  const Vec3d row0 = cross(y, z) / d;
  const Vec3d row1 = cross(z, x) / d;
  const Vec3d row2 = cross(x, y) / d;
  Mat4 b;
  b.m = {row0.x, row1.x, row2.x, 0, row0.y,        row1.y,        row2.y,        0,
         row0.z, row1.z, row2.z, 0, -dot(row0, t), -dot(row1, t), -dot(row2, t), 1};
  return b;
}

void append_object(const Model& model, std::uint32_t number, Scene& scene) {
  const Instance& instance = model.instances[number];
  const std::uint32_t primitive = instance.primitive;
  const Mat4& world = instance.world;
  const Mesh& local = scene.primitives[primitive].mesh;
  if (local.triangles.empty()) return;
  const double d = determinant(world);
  if (!std::isnormal(d)) {
    throw Error(
        ErrorKind::bad_input,
        fmt::format("node '{}': its world matrix has no inverse, it cannot be drawn", instance.node_name));
  }
  const auto first_vertex = static_cast<std::uint32_t>(scene.mesh.positions.size());
  const Mat4 local_from_world = inverse(world, d);
  scene.objects.push_back({primitive, static_cast<std::uint32_t>(scene.mesh.triangles.size()), first_vertex,
                           number, d < 0, local_from_world,
                           transformed_point(world, bounding_sphere(local).center)});
  for (const Vec3f& p : local.positions) {
    scene.mesh.positions.push_back(to_float(transformed_point(world, to_double(p))));
  }
  const std::vector<Vec3f> normals = local.normals.empty() ? vertex_normals(local) : local.normals;
  for (const Vec3f& n : normals) {
    // Normals are transformed by the transposed inverse.
    const auto& m = local_from_world.m;
    const Vec3d v = to_double(n);
    scene.mesh.normals.push_back(
        to_float(normalized(Vec3d{m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
                                  m[8] * v.x + m[9] * v.y + m[10] * v.z})));
  }
  for (const Triangle& t : local.triangles) {
    // A mirrored node shows the same faces as fronts (glTF 2.0, section 3.7.4), so its triangles are turned.
    const Triangle turned = d < 0 ? Triangle{t[0], t[2], t[1]} : t;
    scene.mesh.triangles.push_back(
        {turned[0] + first_vertex, turned[1] + first_vertex, turned[2] + first_vertex});
  }
}

// Returns the camera relative to the bounding sphere of an object, in its radii.
Viewpoint local_viewpoint(const SceneObject& object, const BoundingSphere& sphere, const Camera& camera) {
  if (!camera.perspective) {
    return {normalized(-transformed_direction(object.local_from_world, camera.forward)), kInfiniteDistance};
  }
  const Vec3d eye = transformed_point(object.local_from_world, camera.eye) - sphere.center;
  return {normalized(eye), sphere.radius > 0 ? length(eye) / sphere.radius : kInfiniteDistance};
}

std::vector<std::uint32_t> object_ranks(const CleanPrimitive& primitive, const SceneObject& object,
                                        SceneOrder order, const Camera& camera) {
  const Mesh& mesh = primitive.mesh;
  if (order != SceneOrder::buffers || !primitive.orders) return ranks_as_stored(mesh.triangles.size());
  return ranks_from(mesh, *primitive.orders, local_viewpoint(object, primitive.orders->sphere, camera));
}

std::vector<std::uint32_t> objects_front_to_back(const Scene& scene, const Camera& camera) {
  std::vector<double> depths;
  for (const SceneObject& object : scene.objects) {
    const Vec3d offset = object.center - camera.eye;
    depths.push_back(camera.perspective ? length(offset) : dot(offset, camera.forward));
  }
  std::vector<std::uint32_t> order(scene.objects.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return depths[a] < depths[b]; });
  return order;
}

}  // namespace

bool has_transparency_orders(const Primitive& primitive) {
  return primitive.orders && primitive.orders->purpose == OrderPurpose::transparency;
}

CleanPrimitive clean_primitive(const Primitive& primitive) {
  CleanMesh clean_mesh = clean(primitive.mesh, {}, primitive.name);
  CleanPrimitive result;
  if (primitive.orders) {
    (has_transparency_orders(primitive) ? result.orders : result.overdraw_orders) =
        restrict_orders(*primitive.orders, clean_mesh.source, primitive.mesh.triangles.size());
  }
  result.mesh = std::move(clean_mesh.mesh);
  return result;
}

Scene make_scene(const Model& model) {
  Scene scene;
  for (const Primitive& primitive : model.primitives) {
    scene.primitives.push_back(clean_primitive(primitive));
    const bool single_sided = is_gltf(model) && !primitive.double_sided;
    scene.culled.push_back(has_transparency_orders(primitive) ? primitive.orders->facing == Facing::single
                                                              : single_sided);
  }
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) append_object(model, i, scene);
  if (scene.mesh.triangles.empty()) {
    throw Error(ErrorKind::nothing_to_do,
                model.path + ": nothing to draw: there are no triangles in its scene");
  }
  scene.sphere = bounding_sphere(scene.mesh);
  return scene;
}

std::vector<std::uint32_t> scene_ranks(const Scene& scene, SceneOrder order, const Camera& camera,
                                       const Viewpoint& viewpoint) {
  const std::uint64_t triangles = scene.mesh.triangles.size();
  if (order == SceneOrder::centroid) {
    return ranks_of(centroid_sorted(scene.mesh, scene.sphere, viewpoint), triangles);
  }
  std::vector<std::uint32_t> ranks(2 * triangles, kNoRank);
  std::uint32_t first_rank = 0;
  for (const std::uint32_t o : objects_front_to_back(scene, camera)) {
    const SceneObject& object = scene.objects[o];
    const CleanPrimitive& primitive = scene.primitives[object.primitive];
    const std::vector<std::uint32_t> own = object_ranks(primitive, object, order, camera);
    const std::size_t first_node = 2 * static_cast<std::size_t>(object.first_triangle);
    for (std::size_t node = 0; node < own.size(); ++node) {
      if (own[node] != kNoRank) ranks[first_node + node] = first_rank + own[node];
    }
    first_rank += static_cast<std::uint32_t>(own.size());
  }
  return ranks;
}

FragmentBuffer scene_fragments(const Scene& scene, const Camera& camera) {
  FragmentBuffer all;
  rasterize(scene.mesh, camera, {}, all);
  std::vector<bool> hidden(2 * scene.mesh.triangles.size(), false);
  for (const SceneObject& object : scene.objects) {
    if (!scene.culled[object.primitive]) continue;
    const std::size_t count = scene.primitives[object.primitive].mesh.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      hidden[node_of(object.first_triangle + static_cast<std::uint32_t>(t), true)] = true;
    }
  }
  FragmentBuffer drawn{all.width, all.height, {}, {}};
  drawn.offsets.reserve(all.offsets.size());
  drawn.offsets.push_back(0);
  for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p) {
    for (const Fragment& fragment : all.pixel(p)) {
      if (!hidden[fragment.node]) drawn.fragments.push_back(fragment);
    }
    drawn.offsets.push_back(drawn.fragments.size());
  }
  return drawn;
}

// ----------------------------------------------------------------------------------------------------- poses

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
  throw Error(ErrorKind::bad_argument,
              fmt::format("{} has no animation '{}'; it has {}", path, name, names.empty() ? "none" : names));
}

// Returns for every vertex the first one at the same point of a smooth surface, which has the same position
// and normal.
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

// Returns the posed part as a mesh of its own.
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

// Computes normals of the posed triangles, smooth where those of the file are.
void set_normals(const Mesh& local, Mesh posed, std::span<Vec3f> normals) {
  const std::vector<std::uint32_t> points = smooth_points(local);
  for (Triangle& triangle : posed.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = points[vertex];
  }
  const std::vector<Vec3f> smooth = vertex_normals(posed);
  for (std::size_t v = 0; v < points.size(); ++v) normals[v] = smooth[points[v]];
}

// Turns the triangles of an object if its joints mirror it and its node does not, or the other way round.
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

// --------------------------------------------------------------------------------------------------- cameras

namespace {

ModelCamera find_camera(const Model& model, const std::string& name) {
  const std::vector<ModelCamera> cameras = read_cameras(model);
  std::string names;
  for (const ModelCamera& camera : cameras) {
    if (camera.name == name) return camera;
    names.append(names.empty() ? "" : ", ").append(camera.name.empty() ? "(unnamed)" : camera.name);
  }
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error == std::errc{} && end == name.data() + name.size() && number < cameras.size())
    return cameras[number];
  throw Error(ErrorKind::bad_argument, fmt::format("{} has no camera '{}'; it has {}", model.path, name,
                                                   names.empty() ? "none" : names));
}

// Fits near and far planes to the part of the sphere that lies in front of the camera.
void fit_planes(const BoundingSphere& sphere, Camera& camera) {
  constexpr double kSlack = 1.001;
  constexpr double kNearest = 1e-4;  // of the far plane
  const double depth = dot(sphere.center - camera.eye, camera.forward);
  const double radius = std::max(sphere.radius, 1e-12) * kSlack;
  if (!camera.perspective) {
    camera.eye += camera.forward * (depth - radius);
    camera.near_plane = 0;
    camera.far_plane = 2 * radius;
    return;
  }
  camera.far_plane = std::max(depth + radius, radius);
  camera.near_plane = std::max(depth - radius, kNearest * camera.far_plane);
}

Camera placed_camera(const ModelCamera& source, const BoundingSphere& sphere, std::uint32_t width,
                     std::uint32_t height) {
  const auto& m = source.world.m;
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.perspective = source.perspective;
  camera.half_height = source.half_height;
  camera.eye = {m[12], m[13], m[14]};
  camera.forward = normalized(Vec3d{-m[8], -m[9], -m[10]});
  camera.right = normalized(cross(camera.forward, Vec3d{m[4], m[5], m[6]}));
  camera.up = cross(camera.right, camera.forward);
  const double volume = dot(camera.right, cross(camera.up, -camera.forward));
  if (!(volume > 0.5)) {
    throw Error(ErrorKind::bad_input,
                fmt::format("camera '{}': its node's matrix gives it no direction", source.name));
  }
  fit_planes(sphere, camera);
  return camera;
}

}  // namespace

Camera file_camera(const Model& model, const std::string& name, const BoundingSphere& sphere,
                   std::uint32_t width, std::uint32_t height) {
  return placed_camera(find_camera(model, name), sphere, width, height);
}

}  // namespace pellucid
