// pellucid/render.h - module `render`: all fragments of a pixel on the GPU, by every technique of the
// depth-fighting paper, and what becomes of them.
//
// In: triangles in world space with their objects and surfaces, a camera, the name of a capture technique and
// an effect. Out: a picture and what was captured, counted, not claimed. A capture technique delivers, for
// every pixel, fragments in the order (depth, id), each once: all of them (exact) or a documented part; an
// effect folds that sequence. Paper: Vasilakis, Fudos, "Depth-Fighting Aware Methods for Multi-Fragment
// Rendering", TVCG 2014.
//
// Conventions: depth 0..1 forward, near to far, 32-bit float (raster.h has the formula); back faces are drawn
// where a surface is double-sided; fragment ids as in raster.h (NodeId: 2 * triangle + (1: back face)).
// Fragments of equal depth come in the order of their ids, so pictures do not depend on the sequence of
// drawing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/memory_budget.h"
#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sampling.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------------ device

struct DeviceOptions {
  std::string device;     // part of its name, in any case; empty: a real GPU before the CPU driver
  bool validate = false;  // Vulkan and synchronisation validation; needs the layers
  std::uint64_t max_buffer_bytes = 0;  // less than the device lets a shader address; 0: as much as it does
  // For tests: asked before each call of Vulkan that may fail, with what it is for; a VkResult other than 0
  // is taken for the call's, which is not made.
  std::function<int(std::string_view what)> fault{};
  // Called with what validation says, from any thread, also while the renderer is destroyed.
  std::function<void(const std::string&)> on_message{};
};

struct DeviceInfo {
  std::string name, driver;
  bool cpu = false;                    // a driver that runs on the CPU
  std::uint64_t max_buffer_bytes = 0;  // what a shader may address in one buffer
  std::uint32_t max_side = 0;          // of a picture
  bool atomics64 = false;              // 64-bit atomics on buffers
  bool layered = false;                // vertex shaders may choose the layer of an attachment
  bool precise_queries = false;        // occlusion queries count
  bool conditional = false;            // draws that depend on a query (VK_EXT_conditional_rendering)
  // Attachments that fragment shaders read in the sequence of drawing
  // (VK_EXT_rasterization_order_attachment_access), how many 128-bit ones.
  std::uint32_t ordered_attachments = 0;
  bool interlock = false;  // critical sections of fragment shaders (VK_EXT_fragment_shader_interlock)
};

// ----------------------------------------------------------------------------------------- what is drawn

// Rows from the upper left, where texture coordinates are 0; four bytes a texel: sRGB colour and linear
// opacity, not premultiplied.
struct Texture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  TextureSampling sampling{};
};
// What all textures of a scene take on the device, with their smaller levels: of larger ones the largest are
// halved until they fit.
constexpr std::uint64_t kMostTextureBytes = std::uint64_t{64} << 20U;

struct Surface {
  Vec3f color{1, 1, 1};  // linear
  float alpha = 0.5F;    // opacity of a sheet that is seen head-on
  bool double_sided = true;
  // Where an effect blends, opaque surfaces are not captured: they are drawn first, and fragments at their
  // depth or behind it are none. Their alpha is taken for 1.
  bool opaque = false;
  std::optional<std::uint32_t> texture{};  // index into RenderScene::textures; multiplies colour and alpha
  float cutoff = 0;  // where colours of vertices and texture leave less opacity than this, nothing is drawn
};

struct RenderScene {
  std::vector<Vec3f> positions;  // world space
  std::vector<Vec3f> normals;    // one per position; zero: the face's
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> objects;  // of every triangle: index into `surfaces`
  std::vector<Surface> surfaces;
  std::vector<std::array<float, 2>> texcoords;  // one per position; empty: nothing has a texture
  std::vector<std::array<float, 4>> colors;     // one per position, multiply those of surfaces; empty: all 1
  std::vector<Texture> textures;
  // Drawing sequence of the triangles; empty: as they are. Fragment ids refer to `triangles` all the same.
  // Opaque surfaces that are drawn first have a sequence of their own.
  std::vector<std::uint32_t> sequence;
};

// --------------------------------------------------------------------------------- techniques and effects

enum class Effect {
  transparency,    // all surfaces blended in depth order
  wireframe,       // the same, with opaque edges: hidden ones show through translucent faces
  csg,             // union, intersection or difference of closed solids, at most 32
  self_collision,  // where an object runs through itself, in red; at most 8 objects
  coplanarity,     // the largest group of fragments at one depth, in the paper's colours
  complexity,      // how many fragments a pixel has
  thickness,       // how much of closed solids light has to go through
};
enum class CsgOperation {
  union_of_all,
  intersection,
  difference
};  // difference: the first object minus all others

struct NamedEffect {
  Effect effect;
  std::string name, description;
};
std::span<const NamedEffect> render_effects();

// What becomes of fragments that a pool has no room for. Needs 64-bit atomics.
enum class Overflow {
  // Of every pixel the nearest are kept, in all as many as the pool has nodes. The others are counted and,
  // where the effect blends, seen behind them as one layer of their weighted average colour with the product
  // of their transmittances.
  nearest,
  // All are captured, in as many rounds as it takes: `multikb` in the pool.
  exact
};

// How fragments of a pixel that are shaded at the same time keep out of each other's way, in techniques with
// TechniqueInfo::syncs; what is captured is the same, of techniques with a budget as long as k is.
enum class Sync {
  automatic,  // the first of TechniqueInfo::syncs that the device has; for `kb`, that fits k, too
  atomics,    // chains of 64-bit minima: any k, two geometry passes
  ordered,    // attachments that are read back in the sequence of drawing; k and memory are limited by their
              // number
  interlock,  // critical sections: any k
  atomics32,  // chains of 32-bit minima, of depths and then of ids, which every device has
  spinlock    // critical sections behind a word that is tried RenderOptions::lock_turns times
};
struct NamedSync {
  Sync sync;
  std::string name;
};
// All but `automatic`, the fastest first where only fragments are inserted.
std::span<const NamedSync> sync_ways();
// What `device` lacks for it; empty: nothing.
std::string missing_for(Sync sync, const DeviceInfo& device);

struct TechniqueInfo {
  std::string name;            // "f2b-2p"
  std::string title;           // "front-to-back peeling, two coplanar fragments a round"
  std::string paper;           // where it is from
  bool exact = true;           // captures every fragment, also coplanar ones, given enough memory
  bool order_free = true;      // captures the same fragments in whatever sequence they are drawn
  std::string captures;        // in words, where it is not exact
  std::string passes_formula;  // D: depth layers; C: fragments of a layer; N: fragments of a pixel
  std::string bytes_formula;   // of a pixel
  bool can_cull = false;       // RenderOptions::cull
  // What RenderOptions::sync may be, the preferred first; none: no choice, atomics where they are needed.
  std::vector<Sync> syncs{};
  bool pooled = false;    // RenderOptions::overflow
  bool budgeted = false;  // RenderOptions::memory
  // What does not fit is averaged behind what is kept: for transparency and wireframe.
  bool keeps_tail = false;
  bool blends_only = false;  // delivers no fragments: for transparency and wireframe, without keep_fragments
  bool needs_atomics64 = false, needs_layered = false;
  std::uint32_t needs_ordered = 0;  // of DeviceInfo::ordered_attachments
};
// In the order of the paper's Table 1. None where pellucid was built without Vulkan.
std::span<const TechniqueInfo> render_techniques();
// What `device` lacks for it; empty: nothing.
std::string missing_for(const TechniqueInfo& technique, const DeviceInfo& device);

struct RenderOptions {
  std::string technique = "sb";
  Effect effect = Effect::transparency;
  CsgOperation csg = CsgOperation::union_of_all;
  Vec3f background{1, 1, 1};  // linear
  Vec3f edge_color{0.02F, 0.02F, 0.03F};
  std::uint32_t k = 8;  // fragments, or buckets, of techniques with a fixed number of them; 1 .. 64
  Sync sync = Sync::automatic;
  // Of `k-plus` and `variable-k` in critical sections: pixels with as many slots or more hold them as a heap,
  // others as an array. 16 in the paper.
  std::uint32_t heap_from = 16;
  // Of Sync::spinlock: how often a fragment tries. Then it goes to the tail, and is counted as overflowed.
  std::uint32_t lock_turns = 1024;
  // 1, or 4 at Vulkan's standard places: each sample is a pixel of its own until the picture is averaged,
  // shading, depth and fragments included, so that edges are right where surfaces intersect and coincide,
  // too. Triangles are drawn once for each.
  std::uint32_t samples = 1;
  // Nodes of techniques that store in a pool; 0: as many as there are fragments. Where these are more:
  // `overflow`.
  std::uint64_t pool = 0;
  Overflow overflow = Overflow::nearest;
  // Bytes of buffers of techniques that keep to a budget. 0: `bounded` takes 64 a pixel, `multikb` as many as
  // it needs, `hybrid` as many as hold k, others with a tail 32 a pixel (pellucid/budget.h). `bounded` and
  // `multikb` cut pictures into bands where that is too little for what is kept of every pixel; those with a
  // tail keep to it in each band.
  std::uint64_t memory = 0;
  Allocation allocation = Allocation::water;  // of `variable-k`, and what it goes by
  ImportanceOptions importance{};
  bool maps = false;  // RenderResult::maps, of techniques with a budget
  // Sort with an insertion sort of a local array, as is common: to measure against.
  bool plain_resolve = false;
  // Techniques that peel with the depth test or from both ends: do not draw again what is peeled completely.
  bool cull = false;
  // Count what is captured and how much of it is coplanar. Without, CaptureStats has neither, and kernels
  // that sort leave a pixel where nothing behind can be seen.
  bool statistics = true;
  bool keep_fragments = false;  // RenderResult::fragments; draws twice
};

// ------------------------------------------------------------------------------------------------ results

struct CaptureStats {
  // That were rasterised in front of opaque surfaces, counted in a pass of its own.
  std::uint64_t fragments = 0;
  std::uint64_t captured = 0;    // that the effect was given
  std::uint64_t overflowed = 0;  // that found no place
  // Verified blending: pixels (or samples) where the sequence of drawing was not the order of depths.
  std::uint64_t repaired_pixels = 0;
  std::uint64_t repaired_triangles = 0;  // that were drawn again for it
  // Ordered k-buffer: pixels (or samples) where a fragment came after more than k farther ones, and was
  // blended behind some of them. 0: all were blended in order, the picture is exact.
  std::uint64_t misordered_pixels = 0;
  bool pool_exceeded =
      false;  // RenderOptions::overflow decided what became of them, or they were captured again
  std::uint64_t coplanar = 0;  // captured ones at the depth of another one of their pixel
  std::uint64_t coplanar_pixels = 0, covered_pixels = 0;  // with several samples of a pixel: of those
  std::uint64_t seen_pixels = 0;                          // with fragments in any sample
  std::uint64_t deepest_pixel = 0;                        // most fragments of a pixel
  // Slots for fragments of a covered pixel, of techniques with a budget: least, most, sum.
  std::optional<std::uint32_t> k_least, k_most;
  std::uint64_t k_sum = 0;
  Sync sync = Sync::automatic;  // what was chosen; automatic: the technique has no choice
  // Of `auto`: the technique that it took, and why; several where bands of a picture differ.
  std::string chosen, reason;
  std::uint32_t rounds = 0;             // of techniques that peel
  std::uint32_t geometry_passes = 0;    // how often all triangles were drawn
  std::uint32_t fullscreen_passes = 0;  // compute passes over the picture
  double drawn_share = 1;               // of triangles x geometry passes, with RenderOptions::cull
  std::uint64_t bytes = 0;              // of the technique's own buffers and images
  double milliseconds = 0;              // on the device, from the first clear to the finished picture
  double resolve_milliseconds = 0;      // of them, sorting and folding what was captured
  [[nodiscard]] std::optional<double> k_mean() const {
    if (!k_least || covered_pixels == 0) return std::nullopt;
    return static_cast<double>(k_sum) / static_cast<double>(covered_pixels);
  }
  // The paper's robustness ratio R_h; 1 for an empty picture.
  [[nodiscard]] double captured_share() const {
    return fragments == 0 ? 1 : static_cast<double>(captured) / static_cast<double>(fragments);
  }
};

struct CapturedFragments {
  std::vector<std::uint64_t> offsets;  // of every pixel (or, pixel by pixel, of every sample), and the end
  std::vector<Fragment> fragments;     // as they were delivered
  // Of each: linear colour, lit, and opacity; empty for techniques with a tail.
  std::vector<std::array<float, 4>> colors;
};

struct RenderResult {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3f> pixels;  // linear colour, row by row from the upper left
  CaptureStats stats;
  CapturedFragments fragments;
  BudgetMaps maps;  // with RenderOptions::maps
};

struct OverdrawCount {
  std::uint64_t shaded = 0;   // fragments that a strict depth test lets through, in the sequence of drawing
  std::uint64_t covered = 0;  // pixels; the least that `shaded` can be
};

// The same on the CPU, from the fragments of raster.h: the oracle of all techniques. Colours are not rounded
// on the way, as fragments on the device are (8 bits a channel, gamma 2); CaptureStats has fragments,
// captured, coplanar, pixels and milliseconds. Throws as Renderer::draw does for effects, and for `samples`
// and `cull`, which it has not.
RenderResult draw_reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options);

// A device with one scene on it. Not to be used from several threads at once.
class Renderer {
 public:
  // Throws Error{bad_argument} where no device fits, Error{internal} where it fails: without memory, say, on
  // the device or on the host. After such an error, here or below, nothing of what was begun is left, and the
  // renderer can be used again, unless the device was lost: then all that follows throws.
  explicit Renderer(const DeviceOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  [[nodiscard]] const DeviceInfo& info() const;

  // Copies the scene to the device. Throws Error{bad_argument} for indices out of range, and for scenes that
  // a buffer of the device cannot hold.
  void load(const RenderScene& scene);

  // Draw what was loaded. Pictures whose buffers would be too large for the device are drawn in bands.
  // Throws Error{bad_argument} for a technique that is not there or not possible on this device, and for
  // effects that the scene has too many objects for; Error{interrupted} when `progress` says so.
  RenderResult draw(const Camera& camera, const RenderOptions& options, Progress* progress = nullptr);

  // How often what was loaded would be shaded if it were opaque, counted by the device behind its depth test:
  // the oracle of metric.h's measure_overdraw and of overdraw.h. Surfaces that show both sides are drawn
  // before those that do not. Throws as draw() does.
  OverdrawCount count_overdraw(const Camera& camera);

  // What validation said so far, with DeviceOptions::validate.
  [[nodiscard]] std::vector<std::string> validation_messages() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pellucid
