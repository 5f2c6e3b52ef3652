// What the renderer draws of a Scene, and how its surfaces look.
#pragma once

#include "pellucid/render.h"
#include "pellucid/shading.h"
#include "scene.h"

namespace pellucid::cli {

enum class Surfaces {
  uniform,  // all of one colour and opacity
  file      // base colours and alpha modes of the materials
};

// Every object is one of the Scene's. `look` is that of uniform surfaces, and of formats without materials.
RenderScene make_render_scene(const Model& model, const Scene& scene, Surfaces surfaces,
                              const SurfaceLook& look);

}  // namespace pellucid::cli
