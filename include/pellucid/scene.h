// pellucid/scene.h - module `scene`: what a model draws, with its poses, surfaces and cameras.
//
// In: a Model. Out: its triangles in scene space (that of the default glTF scene) at rest and at any time of
// any clip (node animation, skins, morph targets, Loop subdivision on demand), what a renderer draws of them,
// in which order, and the cameras of the file. Format: glTF 2.0, sections 3.5, 3.7.3, 3.10, 3.11 and appendix
// C.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"
#include "pellucid/shading.h"
#include "pellucid/view.h"

namespace pellucid {

// ----------------------------------------------------------------------------------------- models in motion

// One drawn instance of a primitive. Its triangles and vertices are consecutive ones of the model, up to
// those of the next part.
struct ModelPart {
  std::string name;             // of the primitive
  std::uint32_t primitive = 0;  // index into Model::primitives
  std::uint32_t instance = 0;   // index into Model::instances; 0 where the model has none
  std::uint32_t first_triangle = 0, first_vertex = 0;
  bool double_sided = false;
};

// An animation that moves something drawn.
struct AnimationClip {
  std::string name;
  std::uint32_t animation = 0;  // index into Model::animation_names
  // Seconds, increasing, at least one: the key times of all channels that move something drawn. Of times less
  // than 1e-5 s apart the first remains.
  std::vector<double> key_times;
};

// Returns times at a fixed rate (per second), from the clip's first to its last key time, both included; the
// last step may be shorter. Throws Error{bad_argument} for a rate that is not positive or gives more than a
// million times.
std::vector<double> times_at_rate(const AnimationClip& clip, double rate);

struct PosableData;  // opaque

// A model in any pose of any of its animations. Copies share their data. All methods may be called from
// several threads at once.
class PosableModel {
 public:
  // `subdivisions`: Loop levels, 0 .. kMostSubdivisions (pellucid/subdivide.h). Each part is welded by
  // itself, where positions, joints and morph targets agree, and refined as it lies in the file; joints
  // follow their weights' stencils. Throws as read_rig does, and Error{bad_argument} where the parts have
  // more than 2^28 triangles or vertices.
  explicit PosableModel(const Model& model, std::uint32_t subdivisions = 0);

  // Returns the triangles of all parts, one after the other in the file's order, as indices into the
  // positions. Without subdivision degenerate triangles are kept; with it those with two corners at one place
  // are left out, and the 4^subdivisions children of each of the others follow each other. Parts that are
  // mirrored at rest have their triangles turned, so that fronts are counter-clockwise in scene space.
  [[nodiscard]] const std::vector<Triangle>& triangles() const;
  // Returns the instances of triangle primitives; of a model without instances all triangle primitives.
  [[nodiscard]] const std::vector<ModelPart>& parts() const;
  [[nodiscard]] const std::vector<AnimationClip>& clips() const;

  [[nodiscard]] std::vector<Vec3f> rest_pose() const;
  // Writes the vertices at `time` (seconds) of the clip to `positions`, whose memory is used again. Times
  // outside of a channel's key times are clamped to them. `clip` is an index into clips(); throws
  // Error{bad_argument} for others. Positions that are not finite in the file are not finite here (with
  // subdivision, nor are their neighbours), and those that leave the range of float32 become infinite.
  void pose(std::uint32_t clip, double time, std::vector<Vec3f>& positions) const;

 private:
  std::shared_ptr<const PosableData> data_;
};

// --------------------------------------------------------------------------------- a whole file as one mesh

// A primitive as it is measured and drawn: clean, its orders (if any) referring to the clean mesh.
struct CleanPrimitive {
  Mesh mesh;
  std::optional<OrderSet> orders;           // for transparency
  std::optional<OrderSet> overdraw_orders;  // for opaque faces
};
CleanPrimitive clean_primitive(const Primitive& primitive);

// Returns whether the primitive has orders that promise right images of translucent faces; overdraw orders do
// not.
bool has_transparency_orders(const Primitive& primitive);

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
// Places all instances of the model at rest. Throws Error{nothing_to_do} when no triangle is drawn,
// Error{bad_input} for a world matrix without inverse. O(vertices + triangles).
Scene make_scene(const Model& model);

// How triangles within an object are ordered.
enum class SceneOrder {
  buffers,   // by the in-depth buffer for the object's own local view; as stored where it has none
  original,  // as stored
  centroid,  // all triangles of the scene sorted by their centroids
};
// Returns the rank of every node of Scene::mesh (kNoRank: not drawn). Objects come front to back by their
// centres. `viewpoint` is that of the camera, for `centroid`.
std::vector<std::uint32_t> scene_ranks(const Scene& scene, SceneOrder order, const Camera& camera,
                                       const Viewpoint& viewpoint);

// Returns the fragments that are drawn: without back faces of culled primitives.
FragmentBuffer scene_fragments(const Scene& scene, const Camera& camera);

// Moves the vertices of `scene`, which is that of `model`, to where they are at `time` (seconds) of the
// animation of that name or number, with normals to match; without a name to where skins and morph targets
// have them at rest. Returns the number of the animation, if there is a name. Throws Error{bad_argument} for
// an animation that is not there.
std::optional<std::uint32_t> pose_scene(const Model& model, const std::string& animation, double time,
                                        Scene& scene);

// Returns the camera of that name or number of the model, with its near and far planes fitted to the sphere.
// Throws Error{bad_argument} for a camera that is not there, Error{bad_input} for one without a direction.
Camera file_camera(const Model& model, const std::string& name, const BoundingSphere& sphere,
                   std::uint32_t width, std::uint32_t height);

// --------------------------------------------------------------------------------- what a renderer draws

// An image that surfaces are covered with. Rows begin at the upper left, where texture coordinates are 0. A
// texel has four bytes: sRGB colour and linear opacity, not premultiplied.
struct Texture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  TextureSampling sampling{};
};
// The most bytes that all textures of a scene take on the device, with their smaller levels. The largest
// textures are halved until all fit.
constexpr std::uint64_t kMostTextureBytes = std::uint64_t{64} << 20U;

struct Surface {
  Vec3f color{1, 1, 1};  // linear
  float alpha = 0.5F;    // opacity of a sheet that is seen head-on
  bool double_sided = true;
  // Where an effect blends, opaque surfaces are not captured. They are drawn first, with alpha 1, and hide
  // fragments at their depth or behind it.
  bool opaque = false;
  std::optional<std::uint32_t> texture{};  // index into RenderScene::textures; multiplies colour and alpha
  float cutoff = 0;  // nothing is drawn where vertex colours and texture leave less opacity than this
};

// Triangles in world space with their surfaces: all that a renderer needs besides a camera.
struct RenderScene {
  std::vector<Vec3f> positions;  // world space
  std::vector<Vec3f> normals;    // one per position; zero: the face's
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> objects;  // of every triangle: index into `surfaces`
  std::vector<Surface> surfaces;
  std::vector<std::array<float, 2>> texcoords;  // one per position; empty: nothing has a texture
  std::vector<std::array<float, 4>> colors;     // one per position, multiply those of surfaces; empty: all 1
  std::vector<Texture> textures;
  // The draw order of the triangles; empty: as they are. Fragment ids refer to `triangles` in any case.
  // Opaque surfaces that are drawn first keep this order among themselves.
  std::vector<std::uint32_t> draw_order;
};

enum class Surfaces {
  uniform,  // all of one colour and opacity
  file      // the file's materials: colours, textures, alpha modes
};

// Returns what a renderer draws of `scene`, which is that of `model`: one object for each of its objects.
// `look` is that of uniform surfaces, and of primitives of which the file says nothing. `notes`, where given,
// receives what could not be read. Throws as read_materials does.
RenderScene make_render_scene(const Model& model, const Scene& scene, Surfaces surfaces,
                              const SurfaceLook& look, std::vector<std::string>* notes = nullptr);

// The pose of a scene: at rest, or at a time of an animation of the file.
struct ScenePose {
  std::optional<std::uint32_t> animation;
  double time = 0;  // seconds
};

// Returns the order in which the file's orders draw the triangles for a camera; empty where it has none.
// Objects with overdraw orders come first, by the ranks of these, the others front to back. In-depth orders
// are not for poses. A triangle comes where the side that faces the camera does, and last where no order has
// it.
std::vector<std::uint32_t> drawing_order(const Scene& scene, const Camera& camera, const ScenePose& pose);

}  // namespace pellucid
