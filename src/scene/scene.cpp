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

Vec3d column(const Mat4& a, std::size_t i) {
  return {a.m[4 * i], a.m[4 * i + 1], a.m[4 * i + 2]};
}

// The cofactors of the upper left 3 x 3 part: row i is the cross product of the other two columns. They turn
// normals also where a matrix is flat and has no inverse.
struct Cofactors {
  Vec3d row0, row1, row2;
  double determinant = 0;
};
Cofactors cofactors(const Mat4& a) {
  const Vec3d x = column(a, 0);
  const Vec3d y = column(a, 1);
  const Vec3d z = column(a, 2);
  return {cross(y, z), cross(z, x), cross(x, y), dot(x, cross(y, z))};
}

// Returns the inverse of an affine matrix.
Mat4 inverse(const Mat4& a, const Cofactors& c) {
  const Vec3d t = column(a, 3);
  const Vec3d row0 = c.row0 / c.determinant;
  const Vec3d row1 = c.row1 / c.determinant;
  const Vec3d row2 = c.row2 / c.determinant;
  Mat4 b;
  b.m = {row0.x, row1.x, row2.x, 0, row0.y,        row1.y,        row2.y,        0,
         row0.z, row1.z, row2.z, 0, -dot(row0, t), -dot(row1, t), -dot(row2, t), 1};
  return b;
}

bool is_finite(const Mat4& a) {
  return std::all_of(a.m.begin(), a.m.end(), [](double number) { return std::isfinite(number); });
}

double longest_column(const Mat4& a) {
  return std::max({length(column(a, 0)), length(column(a, 1)), length(column(a, 2))});
}

// Rotations leave rounding where a scale is zero, so volumes and areas are judged by the longest column.

// Returns whether a matrix makes everything flat, or even smaller.
bool is_flat(const Mat4& a, const Cofactors& c) {
  constexpr double kNoVolume = 1e-15;
  return !std::isnormal(c.determinant) ||
         std::abs(c.determinant) <= kNoVolume * std::pow(longest_column(a), 3);
}

// Returns whether a matrix makes everything a line or a point.
bool is_line(const Mat4& a, const Cofactors& c) {
  constexpr double kNoArea = 1e-12;
  const double area = std::max({length(c.row0), length(c.row1), length(c.row2)});
  return !std::isnormal(area) || area <= kNoArea * std::pow(longest_column(a), 2);
}

// Moves the target of a matrix to an origin. The difference is rounded to float32, so that it does not depend
// on how far from the world's origin both are.
Mat4 relative_to(const Vec3d& origin, Mat4 world) {
  const Vec3d offset = to_double(to_float(column(world, 3) - origin));
  world.m[12] = offset.x;
  world.m[13] = offset.y;
  world.m[14] = offset.z;
  return world;
}

// Appends an instance. `by_joints`: its place comes from pose_scene(), and its matrix has no effect.
void append_object(const Model& model, std::uint32_t number, bool by_joints, Scene& scene) {
  const Instance& instance = model.instances[number];
  const std::uint32_t primitive = instance.primitive;
  const Mesh& local = scene.primitives[primitive].mesh;
  if (local.triangles.empty()) return;
  if (!by_joints && !is_finite(instance.world)) {
    throw Error(ErrorKind::bad_input,
                fmt::format("{}: node '{}': its world matrix is not finite", model.path, instance.node_name));
  }
  const Mat4 world = by_joints ? Mat4{} : relative_to(scene.origin, instance.world);
  const Cofactors c = cofactors(world);
  const bool has_inverse = !is_flat(world, c);
  if (!has_inverse && is_line(world, c)) return;
  const auto first_vertex = static_cast<std::uint32_t>(scene.mesh.positions.size());
  const bool mirrored = c.determinant < 0;
  scene.objects.push_back({primitive, static_cast<std::uint32_t>(scene.mesh.triangles.size()), first_vertex,
                           number, mirrored, has_inverse, has_inverse ? inverse(world, c) : Mat4{},
                           transformed_point(world, bounding_sphere(local).center)});
  for (const Vec3f& p : local.positions) {
    scene.mesh.positions.push_back(to_float(transformed_point(world, to_double(p))));
  }
  const std::vector<Vec3f> normals = local.normals.empty() ? vertex_normals(local) : local.normals;
  const double side = mirrored ? -1 : 1;
  for (const Vec3f& n : normals) {
    const Vec3d v = to_double(n) * side;
    scene.mesh.normals.push_back(to_float(normalized(c.row0 * v.x + c.row1 * v.y + c.row2 * v.z)));
  }
  for (const Triangle& t : local.triangles) {
    // A mirrored node shows the same faces as fronts (glTF 2.0, section 3.7.4), so its triangles are turned.
    const Triangle turned = mirrored ? Triangle{t[0], t[2], t[1]} : t;
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
  if (order != SceneOrder::buffers || !primitive.orders || !object.has_inverse)
    return ranks_as_stored(mesh.triangles.size());
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

// Turns the triangles of an object if its joints mirror it and it is not turned yet, or the other way round.
void turn_as(const Triangle& drawn, const Triangle& in_file, std::size_t count, SceneObject& object,
             Scene& scene) {
  const bool turned = drawn[1] - drawn[0] != in_file[1] - in_file[0];
  if (turned == object.mirrored) return;
  object.mirrored = turned;
  for (std::size_t t = 0; t < count; ++t) {
    Triangle& triangle = scene.mesh.triangles[object.first_triangle + t];
    std::swap(triangle[1], triangle[2]);
  }
}

bool deforms(const Model& model) {
  return std::any_of(model.instances.begin(), model.instances.end(), [&](const Instance& instance) {
    const Primitive& primitive = model.primitives[instance.primitive];
    return primitive.triangles && primitive.deforms;
  });
}

// Which objects a pose moves: those that follow joints or morph weights, or all.
enum class Moved { deformed, all };

// Gives objects the positions of a pose of all parts, and normals that belong to them.
void place_deformed(const Model& model, const PosableModel& posable, const std::vector<Vec3f>& positions,
                    Moved moved, Scene& scene) {
  const std::vector<ModelPart>& parts = posable.parts();
  std::size_t next = 0;
  for (SceneObject& object : scene.objects) {
    while (parts[next].instance != object.instance) ++next;
    const ModelPart& part = parts[next];
    if (moved == Moved::deformed && !model.primitives[object.primitive].deforms) continue;
    const CleanPrimitive& primitive = scene.primitives[object.primitive];
    const auto count = static_cast<std::ptrdiff_t>(primitive.mesh.positions.size());
    const auto target = scene.mesh.positions.begin() + object.first_vertex;
    std::copy_n(positions.begin() + part.first_vertex, count, target);
    turn_as(posable.triangles()[part.first_triangle], model.primitives[object.primitive].mesh.triangles[0],
            primitive.mesh.triangles.size(), object, scene);
    set_normals(primitive.mesh, posed_part(scene, object, primitive.mesh, scene.mesh.positions),
                std::span(scene.mesh.normals).subspan(object.first_vertex, static_cast<std::size_t>(count)));
  }
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

Vec3d scene_origin(const Model& model) {
  constexpr double kFar = 64;  // radii
  if (deforms(model)) return PosableModel(model).anchor();
  for (const Instance& instance : model.instances) {
    const Mesh& mesh = model.primitives[instance.primitive].mesh;
    if (mesh.triangles.empty() || !is_finite(instance.world)) continue;
    if (is_line(instance.world, cofactors(instance.world))) continue;  // not drawn
    // Vertices that are far from their node keep what precision they have.
    const BoundingSphere sphere = bounding_sphere(mesh);
    const bool far = length(sphere.center) > kFar * sphere.radius;
    const Vec3d center = far ? to_double(to_float(sphere.center)) : Vec3d{};
    return transformed_point(instance.world, center);
  }
  return {};
}

Scene make_scene(const Model& model) {
  Scene scene;
  scene.origin = scene_origin(model);
  for (const Primitive& primitive : model.primitives) {
    scene.primitives.push_back(clean_primitive(primitive));
    const bool single_sided = is_gltf(model) && !primitive.double_sided;
    scene.culled.push_back(has_transparency_orders(primitive) ? primitive.orders->facing == Facing::single
                                                              : single_sided);
  }
  std::vector<bool> by_joints(model.instances.size(), false);
  std::optional<PosableModel> posable;
  if (deforms(model)) {
    posable.emplace(model, 0, scene.origin);
    for (const ModelPart& part : posable->parts()) by_joints[part.instance] = part.skinned;
  }
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) append_object(model, i, by_joints[i], scene);
  if (scene.mesh.triangles.empty()) {
    throw Error(ErrorKind::nothing_to_do,
                model.path + ": nothing to draw: there are no triangles in its scene");
  }
  if (posable) place_deformed(model, *posable, posable->rest_pose(), Moved::deformed, scene);
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

}  // namespace

std::optional<std::uint32_t> pose_scene(const Model& model, const std::string& animation, double time,
                                        Scene& scene) {
  if (animation.empty()) return {};
  const PosableModel posable(model, 0, scene.origin);
  const std::uint32_t clip = find_clip(posable, model.path, animation);
  std::vector<Vec3f> positions;
  posable.pose(clip, time, positions);
  place_deformed(model, posable, positions, Moved::all, scene);
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

Camera placed_camera(const ModelCamera& source, const Scene& scene, std::uint32_t width,
                     std::uint32_t height) {
  const auto& m = source.world.m;
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.perspective = source.perspective;
  camera.half_height = source.half_height;
  camera.eye = Vec3d{m[12], m[13], m[14]} - scene.origin;
  camera.forward = normalized(Vec3d{-m[8], -m[9], -m[10]});
  camera.right = normalized(cross(camera.forward, Vec3d{m[4], m[5], m[6]}));
  camera.up = cross(camera.right, camera.forward);
  const double volume = dot(camera.right, cross(camera.up, -camera.forward));
  if (!(volume > 0.5)) {
    throw Error(ErrorKind::bad_input,
                fmt::format("camera '{}': its node's matrix gives it no direction", source.name));
  }
  fit_planes(scene.sphere, camera);
  return camera;
}

}  // namespace

Camera file_camera(const Model& model, const std::string& name, const Scene& scene, std::uint32_t width,
                   std::uint32_t height) {
  return placed_camera(find_camera(model, name), scene, width, height);
}

}  // namespace pellucid
