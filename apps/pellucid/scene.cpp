// A whole file as one mesh: see scene.h.
#include "scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pellucid/report.h"
#include "selection.h"

namespace pellucid::cli {
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

// Inverse of an affine matrix with determinant `d`.
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
    // Normals go with the transposed inverse.
    const auto& m = local_from_world.m;
    const Vec3d v = to_double(n);
    scene.mesh.normals.push_back(
        to_float(normalized(Vec3d{m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
                                  m[8] * v.x + m[9] * v.y + m[10] * v.z})));
  }
  for (const Triangle& t : local.triangles) {
    // A mirrored node shows the same faces as fronts (glTF 3.7.4): turn its triangles back.
    const Triangle turned = d < 0 ? Triangle{t[0], t[2], t[1]} : t;
    scene.mesh.triangles.push_back(
        {turned[0] + first_vertex, turned[1] + first_vertex, turned[2] + first_vertex});
  }
}

// The camera as an object sees it: relative to its bounding sphere, in its radii.
Viewpoint local_viewpoint(const SceneObject& object, const BoundingSphere& sphere, const Camera& camera) {
  if (!camera.perspective) {
    return {normalized(-transformed_direction(object.local_from_world, camera.forward)), kInfiniteDistance};
  }
  const Vec3d eye = transformed_point(object.local_from_world, camera.eye) - sphere.center;
  return {normalized(eye), sphere.radius > 0 ? length(eye) / sphere.radius : kInfiniteDistance};
}

std::vector<std::uint32_t> object_ranks(const CleanPrimitive& primitive, const SceneObject& object,
                                        DrawOrder order, const Camera& camera) {
  const Mesh& mesh = primitive.mesh;
  if (order != DrawOrder::buffers || !primitive.orders) return ranks_as_stored(mesh.triangles.size());
  return ranks_from(mesh, *primitive.orders, local_viewpoint(object, primitive.orders->sphere, camera));
}

std::vector<std::uint32_t> objects_front_to_back(const Scene& scene, const Camera& camera) {
  std::vector<double> depths;
  for (const SceneObject& object : scene.objects) {
    const Vec3d offset = object.center - camera.eye;
    depths.push_back(camera.perspective ? length(offset) : dot(offset, camera.forward));
  }
  std::vector<std::uint32_t> sequence(scene.objects.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return depths[a] < depths[b]; });
  return sequence;
}

}  // namespace

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

std::vector<std::uint32_t> scene_ranks(const Scene& scene, DrawOrder order, const Camera& camera,
                                       const Viewpoint& viewpoint) {
  const std::uint64_t triangles = scene.mesh.triangles.size();
  if (order == DrawOrder::centroid) {
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

}  // namespace pellucid::cli
