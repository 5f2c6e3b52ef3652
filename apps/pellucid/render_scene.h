// What the renderer draws of a Scene, and how its surfaces look.
#pragma once

#include <optional>

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

// When the scene is drawn: at rest, or at a time (seconds) of an animation of the file.
struct Moment {
  std::optional<std::uint32_t> animation;
  double time = 0;
};

// The sequence in which the file's orders draw the triangles for a camera; empty where it has none. Objects
// with overdraw orders come first, in the sequence of their ranks, the others front to back. In-depth orders
// are not for poses. A triangle comes where the side that faces the camera does, and last where no order has
// it.
std::vector<std::uint32_t> drawing_sequence(const Scene& scene, const Camera& camera, const Moment& moment);

}  // namespace pellucid::cli
