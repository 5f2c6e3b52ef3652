// From a Scene to what the renderer draws: see render_scene.h.
#include "render_scene.h"

#include "selection.h"

namespace pellucid::cli {
namespace {

Surface surface_of(const Model& model, const Primitive& primitive, Surfaces surfaces,
                   const SurfaceLook& look) {
  if (surfaces == Surfaces::uniform || !is_gltf(model))
    return {look.color, static_cast<float>(look.alpha), true};
  const std::array<float, 4>& c = primitive.base_color;
  // A mask cuts holes by a texture, which is not read: what is left is opaque.
  const bool opaque = primitive.alpha_mode != AlphaMode::blend;
  return {{c[0], c[1], c[2]}, opaque ? 1.0F : c[3], true, opaque};
}

}  // namespace

RenderScene make_render_scene(const Model& model, const Scene& scene, Surfaces surfaces,
                              const SurfaceLook& look) {
  RenderScene out;
  out.positions = scene.mesh.positions;
  out.normals = scene.mesh.normals;
  out.triangles = scene.mesh.triangles;
  out.objects.resize(out.triangles.size());
  for (const SceneObject& object : scene.objects) {
    const auto number = static_cast<std::uint32_t>(out.surfaces.size());
    out.surfaces.push_back(surface_of(model, model.primitives[object.primitive], surfaces, look));
    out.surfaces.back().double_sided = !scene.culled[object.primitive];
    const std::size_t count = scene.primitives[object.primitive].mesh.triangles.size();
    for (std::size_t t = 0; t < count; ++t) out.objects[object.first_triangle + t] = number;
  }
  return out;
}

}  // namespace pellucid::cli
