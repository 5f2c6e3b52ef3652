// pellucid/scene.h - module `scene`: says what a model draws, with its poses, surfaces and cameras.
//
// In: a Model. Out: its triangles in scene space (the space of the default glTF scene), at rest and at any
// time of an animation; what a renderer draws of them, and in which order; and the cameras of the file. Poses
// follow node animation, skins and morph targets, with Loop subdivision on request. Format: glTF 2.0,
// sections 3.5, 3.7.3, 3.10, 3.11 and appendix C.
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

// One drawn instance of a primitive. Its triangles and vertices are consecutive in the model and end where
// those of the next part begin.
struct ModelPart {
  std::string name;             // of the primitive
  std::uint32_t primitive = 0;  // index into Model::primitives
  std::uint32_t instance = 0;   // index into Model::instances; 0 if the model has none
  std::uint32_t first_triangle = 0, first_vertex = 0;
  bool double_sided = false;
  bool skinned = false;  // follows joints; the transform of its node has no effect
};

// An animation that moves something drawn.
struct AnimationClip {
  std::string name;
  std::uint32_t animation = 0;  // index into Model::animation_names
  // The key times of all channels that move something drawn: seconds, increasing, at least one. Of times less
  // than 1e-5 s apart only the first remains.
  std::vector<double> key_times;
};

// Returns times at a fixed rate (per second) from the first to the last key time of the clip, both included.
// The last step may be shorter. Throws Error{bad_argument} if the rate is not positive or gives more than a
// million times.
std::vector<double> times_at_rate(const AnimationClip& clip, double rate);

struct PosableData;  // opaque

// A model in any pose of any of its animations. Copies share their data. All methods may be called from
// several threads at once.
class PosableModel {
 public:
  // `subdivisions` is the number of Loop subdivision levels, 0 .. kMostSubdivisions (pellucid/subdivide.h).
  // Each part is welded by itself, where positions, joints and morph targets agree, and is refined in the
  // space of the file. The joint weights of new vertices follow from the subdivision rule. Positions are
  // relative to `origin` if there is one, and have float32's precision around it. Throws as read_rig() does,
  // and Error{bad_argument} if the parts have more than 2^28 triangles or vertices.
  explicit PosableModel(const Model& model, std::uint32_t subdivisions = 0,
                        const std::optional<Vec3d>& origin = {});

  // Returns the triangles of all parts in the order of the file, as indices into the positions. Without
  // subdivision degenerate triangles are kept. With subdivision, triangles with two corners at one place are
  // left out, and each other triangle becomes 4^subdivisions consecutive ones. The triangles of parts that
  // are mirrored at rest are turned, so that front faces are counter-clockwise in scene space.
  [[nodiscard]] const std::vector<Triangle>& triangles() const;
  // Returns the instances of triangle primitives. For a model without instances, returns all triangle
  // primitives.
  [[nodiscard]] const std::vector<ModelPart>& parts() const;
  [[nodiscard]] const std::vector<AnimationClip>& clips() const;

  [[nodiscard]] std::vector<Vec3f> rest_pose() const;
  // Returns where the node of the first part is at rest, or the first joint that it follows; zero without
  // parts.
  [[nodiscard]] Vec3d anchor() const;
  // Writes the vertices at `time` (seconds) of the clip to `positions`, whose memory is reused. Times outside
  // the key times of a channel are clamped. `clip` is an index into clips(); throws Error{bad_argument} for
  // others. Positions that are not finite in the file are not finite here either, and with subdivision the
  // same holds for their neighbours. Positions beyond the range of float32 become infinite.
  void pose(std::uint32_t clip, double time, std::vector<Vec3f>& positions) const;

 private:
  std::shared_ptr<const PosableData> data_;
};

// --------------------------------------------------------------------------------- a whole file as one mesh

// A primitive as it is measured and drawn. The mesh is clean, and the orders refer to the clean mesh.
struct CleanPrimitive {
  Mesh mesh;
  std::optional<OrderSet> orders;           // for transparency
  std::optional<OrderSet> overdraw_orders;  // for opaque faces
};
// Cleans the mesh of a primitive and converts its orders.
CleanPrimitive clean_primitive(const Primitive& primitive);

// Returns whether the primitive has orders for the blending of translucent faces. Overdraw orders do not
// count.
bool has_transparency_orders(const Primitive& primitive);

struct SceneObject {
  std::uint32_t primitive = 0;       // index into Scene::primitives
  std::uint32_t first_triangle = 0;  // of Scene::mesh
  std::uint32_t first_vertex = 0;
  std::uint32_t instance = 0;  // index into Model::instances
  bool mirrored = false;       // its triangles were turned, because its world matrix or its joints mirror
  // False for an instance that its matrix makes flat: it has no view of its own, and is drawn as stored.
  bool has_inverse = true;
  Mat4 local_from_world;  // `world` as in Scene::mesh; identity without an inverse
  Vec3d center;           // of its bounding sphere, in the space of Scene::mesh
};

struct Scene {
  std::vector<CleanPrimitive> primitives;
  std::vector<bool> culled;  // one per primitive: back faces are not drawn
  std::vector<SceneObject> objects;
  // All objects in world space, relative to `origin`; triangles of mirrored objects are turned. Cameras are
  // relative to the origin as well.
  Mesh mesh;
  BoundingSphere sphere;  // of `mesh`
  Vec3d origin;           // world space, of scene_origin()
};
// Returns a point of the world near the first thing that the model draws. It moves exactly with the model, so
// that a model far from the world's origin gives the same Scene::mesh as one near it.
Vec3d scene_origin(const Model& model);
// Places all instances of the model at rest: by the transforms of their nodes, or by their skins and morph
// weights. Skips instances that their matrix makes smaller than a plane. Throws Error{nothing_to_do} if no
// triangle is drawn, and Error{bad_input} for a world matrix that is not finite. Takes O(vertices +
// triangles).
Scene make_scene(const Model& model);

// How triangles within an object are ordered.
enum class SceneOrder {
  buffers,   // by the in-depth buffer for the view of the object; as stored if it has none
  original,  // as stored
  centroid,  // all triangles of the scene sorted by their centroids
};
// Returns the rank of every node of Scene::mesh (kNoRank: not drawn). Objects are drawn front to back by
// their centres. SceneOrder::centroid uses `viewpoint`, which must be that of the camera.
std::vector<std::uint32_t> scene_ranks(const Scene& scene, SceneOrder order, const Camera& camera,
                                       const Viewpoint& viewpoint);

// Returns the fragments that are drawn, without back faces of culled primitives.
FragmentBuffer scene_fragments(const Scene& scene, const Camera& camera);

// Moves the vertices of `scene`, which make_scene() made of `model`, to their positions at `time` (seconds)
// of an animation, and updates the normals. `animation` is a name or a number. If it is empty, vertices move
// to where skins and morph targets have them at rest. Returns the number of the animation, if there is one.
// Throws Error{bad_argument} for an animation that does not exist.
std::optional<std::uint32_t> pose_scene(const Model& model, const std::string& animation, double time,
                                        Scene& scene);

// Returns a camera of the model by its name or number, with near and far planes fitted to the scene. Throws
// Error{bad_argument} for a camera that does not exist, and Error{bad_input} for one without a direction.
Camera file_camera(const Model& model, const std::string& name, const Scene& scene, std::uint32_t width,
                   std::uint32_t height);

// --------------------------------------------------------------------------------- what a renderer draws

// An image that covers surfaces. Rows begin at the upper left, where texture coordinates are 0. A texel has
// four bytes: sRGB colour and linear opacity, not premultiplied.
struct Texture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  TextureSampling sampling{};
};
// The largest number of bytes that all textures of a scene take on the device, with their smaller levels. The
// largest textures are halved until all fit.
constexpr std::uint64_t kMostTextureBytes = std::uint64_t{64} << 20U;

struct Surface {
  Vec3f color{1, 1, 1};  // linear
  float alpha = 0.5F;    // opacity of a sheet that is seen head-on
  bool double_sided = true;
  // For effects that blend, opaque surfaces are not captured. They are drawn first, with alpha 1, and hide
  // fragments at their depth or behind it.
  bool opaque = false;
  std::optional<std::uint32_t> texture{};  // index into RenderScene::textures; multiplies colour and alpha
  bool unlit = false;                      // the colour is what is seen, without light
  Vec3f emissive{0, 0, 0};                 // linear; added to what light makes
  std::optional<std::uint32_t> emissive_texture{};  // multiplies `emissive`
  float cutoff = 0;  // where vertex colours and texture leave less opacity than this, nothing is drawn
};

// Triangles in world space with their surfaces. The world may have any origin near the triangles, since
// positions are float32 (Scene::origin). This is all that a renderer needs besides a camera.
struct RenderScene {
  std::vector<Vec3f> positions;  // world space
  std::vector<Vec3f> normals;    // one per position; zero: the normal of the face is used
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> objects;  // per triangle: index into `surfaces`
  std::vector<Surface> surfaces;
  std::vector<std::array<float, 2>> texcoords;  // one per position; empty: there are no textures
  std::vector<std::array<float, 4>>
      colors;  // one per position; multiply the colours of surfaces; empty: all 1
  std::vector<Texture> textures;
  // The draw order of the triangles; empty: as they are. Fragment ids refer to `triangles` in any case.
  // Opaque surfaces that are drawn first keep this order among themselves.
  std::vector<std::uint32_t> draw_order;
};

enum class Surfaces {
  uniform,  // all surfaces have one colour and opacity
  file      // the file's materials: colours, textures, alpha modes
};

// Returns what a renderer draws of `scene`, which make_scene() made of `model`. Every object of the scene
// becomes one object. `look` is used for uniform surfaces, and for primitives if the file does not say how
// they look. `notes`, unless null, receives what could not be read. Throws as read_materials() does.
RenderScene make_render_scene(const Model& model, const Scene& scene, Surfaces surfaces,
                              const SurfaceLook& look, std::vector<std::string>* notes = nullptr);

// The pose of a scene: at rest, or at a time of an animation of the file.
struct ScenePose {
  std::optional<std::uint32_t> animation;
  double time = 0;  // seconds
};

// Returns the draw order of the triangles by the orders of the file, for a camera; empty if the file has no
// orders. Objects with overdraw orders come first, by the ranks of these orders. The others follow from front
// to back. In-depth orders do not apply to poses. The rank of a triangle is that of the side that faces the
// camera. Triangles without a rank come last.
std::vector<std::uint32_t> drawing_order(const Scene& scene, const Camera& camera, const ScenePose& pose);

}  // namespace pellucid
