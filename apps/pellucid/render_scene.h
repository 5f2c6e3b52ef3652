// What the renderer draws of a Scene, and how its surfaces look.
#pragma once

#include "pellucid/render.h"
#include "pellucid/shading.h"
#include "scene.h"

namespace pellucid::cli {

enum class Surfaces {
  uniform,  // all of one colour and opacity
  file      // the file's materials: colours, textures, alpha modes
};

// Every object is one of the Scene's. `look` is that of uniform surfaces, and of primitives of which the file
// says nothing. `notes`, where given, receives what could not be read. Throws as read_materials does.
RenderScene make_render_scene(const Model& model, const Scene& scene, Surfaces surfaces,
                              const SurfaceLook& look, std::vector<std::string>* notes = nullptr);

// The sequence in which the file's in-depth orders draw the triangles for a camera; empty where it has none.
// A triangle comes where the first of its sides does, and last where no order has it.
std::vector<std::uint32_t> drawing_sequence(const Scene& scene, const Camera& camera);

}  // namespace pellucid::cli
