// Implements make_render_scene() and drawing_order() of pellucid/scene.h: surfaces and draw orders of scenes.
#include <algorithm>
#include <iterator>
#include <numeric>

#include "pellucid/material.h"
#include "pellucid/scene.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

std::vector<Texture> textures_of(const Materials& materials) {
  std::vector<Texture> textures;
  for (const ModelTexture& texture : materials.textures) {
    const RgbaImage& picture = materials.images[texture.image];
    textures.push_back({picture.width, picture.height, picture.rgba, texture.sampling});
  }
  return textures;
}

Surface surface_of(const PrimitiveLook& file, const SurfaceLook& uniform) {
  Surface surface;
  if (!file.known) {
    surface.color = uniform.color;
    surface.alpha = static_cast<float>(uniform.alpha);
    return surface;
  }
  const std::array<float, 4>& c = file.base_color;
  surface.color = {c[0], c[1], c[2]};
  surface.alpha = c[3];
  surface.opaque = file.alpha_mode != AlphaMode::blend;
  surface.texture = file.texture;
  surface.unlit = file.unlit;
  surface.emissive = {file.emissive[0], file.emissive[1], file.emissive[2]};
  surface.emissive_texture = file.emissive_texture;
  if (file.alpha_mode == AlphaMode::mask) surface.cutoff = file.alpha_cutoff;
  return surface;
}

// Copies colours and texture coordinates of the vertices of an object, if this or another object has any.
void copy_attributes(const PrimitiveLook& look, std::uint32_t first_vertex, RenderScene& scene) {
  const auto first = static_cast<std::ptrdiff_t>(first_vertex);
  if (!look.texcoords.empty()) {
    scene.texcoords.resize(scene.positions.size());
    std::copy(look.texcoords.begin(), look.texcoords.end(), scene.texcoords.begin() + first);
  }
  if (!look.colors.empty()) {
    scene.colors.resize(scene.positions.size(), {1, 1, 1, 1});
    std::copy(look.colors.begin(), look.colors.end(), scene.colors.begin() + first);
  }
}

}  // namespace

RenderScene make_render_scene(const Model& model, const Scene& scene, Surfaces surfaces,
                              const SurfaceLook& look, std::vector<std::string>* notes) {
  Materials materials;
  if (surfaces == Surfaces::file) materials = read_materials(model);
  materials.primitives.resize(model.primitives.size());
  if (notes != nullptr) notes->insert(notes->end(), materials.notes.begin(), materials.notes.end());

  RenderScene out;
  out.positions = scene.mesh.positions;
  out.normals = scene.mesh.normals;
  out.triangles = scene.mesh.triangles;
  out.objects.resize(out.triangles.size());
  out.textures = textures_of(materials);
  for (const SceneObject& object : scene.objects) {
    const auto number = static_cast<std::uint32_t>(out.surfaces.size());
    const PrimitiveLook& file = materials.primitives[object.primitive];
    out.surfaces.push_back(surface_of(file, look));
    out.surfaces.back().double_sided = !scene.culled[object.primitive];
    copy_attributes(file, object.first_vertex, out);
    const std::size_t count = scene.primitives[object.primitive].mesh.triangles.size();
    for (std::size_t t = 0; t < count; ++t) out.objects[object.first_triangle + t] = number;
  }
  return out;
}

namespace {

// Returns whether the camera sees the front of the triangle, from where its corners are counter-clockwise.
bool shows_front(const Mesh& mesh, std::uint32_t triangle, const Camera& camera) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3d a = to_double(mesh.positions[t[0]]);
  const Vec3d normal = cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a);
  return dot(normal, camera.perspective ? camera.eye - a : -camera.forward) > 0;
}

// Appends triangles by their ranks. Ranks belong to nodes, so the side that the camera sees decides.
void append_in_order(const std::vector<std::uint32_t>& ranks, std::uint32_t first_triangle,
                     const Scene& scene, const Camera& camera, std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> own(ranks.size() / 2);
  std::vector<std::uint32_t> seen(own.size());
  std::iota(own.begin(), own.end(), 0U);
  for (const std::uint32_t t : own) {
    const bool front = shows_front(scene.mesh, first_triangle + t, camera);
    const std::uint32_t rank = ranks[node_of(t, !front)];
    seen[t] = rank != kNoRank ? rank : ranks[node_of(t, front)];
  }
  std::stable_sort(own.begin(), own.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return seen[a] < seen[b]; });
  for (const std::uint32_t t : own) order.push_back(first_triangle + t);
}

// Returns which of its overdraw orders draws a primitive, and nothing for animations that the orders were not
// made for.
std::optional<std::uint32_t> overdraw_order(const OrderSet& set, const Vec3d& origin, const Camera& camera,
                                            const ScenePose& pose) {
  // Overdraw orders of a file are made in world space.
  const Vec3d eye = camera.eye + origin;
  if (!pose.animation) {
    return select_order(set, camera.perspective ? eye - set.sphere.center : -camera.forward);
  }
  for (std::size_t i = 0; i < set.animations.size(); ++i) {
    const KeyFrameTable& table = set.animations[i];
    if (table.animation != *pose.animation) continue;
    if (camera.perspective) return select_order_at(set, i, pose.time, eye);
    return select_order(set, i, nearest_key_frame(table, pose.time), -camera.forward);
  }
  return std::nullopt;
}

// An object with overdraw orders, and the order that draws it.
struct OverdrawObject {
  std::uint32_t object = 0, order = 0;
  std::uint32_t rank = 0;  // among those of the model
};
// Returns the objects that overdraw orders draw, sorted by their ranks within the model.
std::vector<OverdrawObject> overdraw_objects(const Scene& scene, const Camera& camera,
                                             const ScenePose& pose) {
  std::vector<OverdrawObject> chosen;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const std::optional<OrderSet>& set = scene.primitives[scene.objects[o].primitive].overdraw_orders;
    if (!set) continue;
    const std::optional<std::uint32_t> order = overdraw_order(*set, scene.origin, camera, pose);
    if (order) chosen.push_back({o, *order, set->model_ranks.empty() ? 0 : set->model_ranks[*order]});
  }
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const OverdrawObject& a, const OverdrawObject& b) { return a.rank < b.rank; });
  return chosen;
}

}  // namespace

std::vector<std::uint32_t> drawing_order(const Scene& scene, const Camera& camera, const ScenePose& pose) {
  const bool in_depth =
      !pose.animation && std::any_of(scene.primitives.begin(), scene.primitives.end(),
                                     [](const CleanPrimitive& p) { return p.orders.has_value(); });
  const std::vector<OverdrawObject> opaque = overdraw_objects(scene, camera, pose);
  std::vector<std::uint32_t> order;
  if (!in_depth && opaque.empty()) return order;
  std::vector<std::uint8_t> drawn(scene.mesh.triangles.size(), 0);
  for (const OverdrawObject& chosen : opaque) {
    const SceneObject& object = scene.objects[chosen.object];
    const CleanPrimitive& primitive = scene.primitives[object.primitive];
    const auto count = static_cast<std::uint32_t>(primitive.mesh.triangles.size());
    append_in_order(ranks_of(primitive.overdraw_orders->orders[chosen.order], count), object.first_triangle,
                    scene, camera, order);
  }
  for (const std::uint32_t t : order) drawn[t] = 1;
  std::vector<std::uint32_t> others;
  append_in_order(scene_ranks(scene, in_depth ? SceneOrder::buffers : SceneOrder::original, camera, {}), 0,
                  scene, camera, others);
  std::copy_if(others.begin(), others.end(), std::back_inserter(order),
               [&](std::uint32_t t) { return drawn[t] == 0; });
  return order;
}

}  // namespace pellucid
