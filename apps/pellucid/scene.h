// A whole file as one mesh in world space, and the orders in which its objects' triangles may be drawn.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_text.h"
#include "cleaned.h"
#include "pellucid/asset.h"
#include "pellucid/raster.h"
#include "pellucid/view.h"

namespace pellucid::cli {

struct SceneObject {
  std::uint32_t primitive = 0;       // index into Scene::primitives
  std::uint32_t first_triangle = 0;  // of Scene::mesh
  std::uint32_t first_vertex = 0;
  std::uint32_t instance = 0;  // index into Model::instances
  bool mirrored = false;       // its triangles were turned
  Mat4 local_from_world;
  Vec3d center;  // of its bounding sphere, in the world
};

struct Scene {
  std::vector<CleanPrimitive> primitives;
  std::vector<bool> culled;  // one per primitive: back faces are not drawn
  std::vector<SceneObject> objects;
  Mesh mesh;              // all objects in world space, mirrored ones turned right
  BoundingSphere sphere;  // of `mesh`
};
// Throws Error{nothing_to_do} when no triangle is drawn, Error{bad_input} for a world matrix without inverse.
Scene make_scene(const Model& model);

// Rank of every node of Scene::mesh, objects front to back by their centres, within an object:
enum class DrawOrder {
  buffers,   // the in-depth buffer for its own local view; the stored order where it has none
  original,  // the stored order of triangles
  centroid,  // all triangles of the scene sorted by their centroids
};
std::vector<std::uint32_t> scene_ranks(const Scene& scene, DrawOrder order, const Camera& camera,
                                       const Viewpoint& viewpoint);

// The fragments that are drawn: without back faces of culled primitives.
FragmentBuffer scene_fragments(const Scene& scene, const Camera& camera);

}  // namespace pellucid::cli
