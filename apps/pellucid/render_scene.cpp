// From a Scene to what the renderer draws: see render_scene.h.
#include "render_scene.h"

#include <algorithm>
#include <numeric>

#include "pellucid/material.h"

namespace pellucid::cli {
namespace {

Wrap wrap_of(TextureWrap wrap) {
  if (wrap == TextureWrap::mirror) return Wrap::mirror;
  return wrap == TextureWrap::clamp ? Wrap::clamp : Wrap::repeat;
}

std::vector<Texture> textures_of(const Materials& materials) {
  std::vector<Texture> textures;
  for (const ModelTexture& texture : materials.textures) {
    const Picture& picture = materials.pictures[texture.picture];
    textures.push_back(
        {picture.width, picture.height, picture.rgba, wrap_of(texture.wrap_u), wrap_of(texture.wrap_v)});
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
  if (file.alpha_mode == AlphaMode::mask) surface.cutoff = file.alpha_cutoff;
  return surface;
}

// Colours and texture coordinates of an object's vertices, where others or it have some.
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

std::vector<std::uint32_t> drawing_sequence(const Scene& scene, const Camera& camera) {
  const bool ordered = std::any_of(scene.primitives.begin(), scene.primitives.end(),
                                   [](const CleanPrimitive& p) { return p.orders.has_value(); });
  if (!ordered) return {};
  const std::vector<std::uint32_t> ranks = scene_ranks(scene, DrawOrder::buffers, camera, {});
  std::vector<std::uint32_t> sequence(scene.mesh.triangles.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  const auto rank = [&](std::uint32_t t) {
    return std::min(ranks[node_of(t, false)], ranks[node_of(t, true)]);
  };
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
  return sequence;
}

}  // namespace pellucid::cli
