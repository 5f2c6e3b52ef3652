// pellucid/render_options.h - module `render`: effects, capture techniques, and the options of drawing.
//
// This header defines the options that Renderer::draw() takes, and lists the effects and techniques. A
// capture technique delivers the fragments of every pixel, and an effect folds them into a colour.
// TechniqueInfo says what a technique keeps, what it costs and which options it uses. Based on: Vasilakis,
// Fudos, "Depth-Fighting Aware Methods for Multi-Fragment Rendering", TVCG 2014.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pellucid/memory_budget.h"
#include "pellucid/mesh.h"

namespace pellucid {

struct DeviceInfo;

// ------------------------------------------------------------------------------------------------ effects

enum class Effect {
  transparency,    // all surfaces blended in depth order
  wireframe,       // the same with opaque edges; hidden edges show through translucent faces
  csg,             // union, intersection or difference of closed solids, at most 32
  self_collision,  // shows in red where an object intersects itself; at most 8 objects
  coplanarity,     // the largest group of fragments at one depth, in the colours of the paper
  complexity,      // the number of fragments of a pixel
  thickness,       // the length of the path of light through closed solids
};
// The difference is the first object minus all others.
enum class CsgOperation { union_of_all, intersection, difference };

struct NamedEffect {
  Effect effect;
  std::string name, description;
};
std::span<const NamedEffect> render_effects();

// -------------------------------------------------------------------------------------------------- options

// What happens to fragments that do not fit into a pool or a memory budget. Both values need 64-bit atomics.
enum class Overflow {
  // Keeps the nearest fragments of every pixel, in total as many as the pool has nodes, and counts the
  // others. If the effect blends, the others are shown behind them as one layer. Its colour is their weighted
  // average, and its transmittance is the product of theirs.
  nearest,
  // Captures all fragments in as many rounds as necessary, as `multikb` does, in the memory of the pool.
  exact
};

// Options of techniques that store their fragments in a pool of nodes: `sb`, `ll` and `bun-ll`, and for the
// fragments of one layer `f2b-ll` and `dual-ll`.
struct PoolOptions {
  std::uint64_t nodes = 0;  // 0: as many as there are fragments
  // What is done if there are more fragments than nodes. `auto` applies it to BudgetOptions::bytes.
  Overflow overflow = Overflow::nearest;
};

// Options of techniques with a memory budget: `fixed-k`, `hybrid`, `k-plus`, `variable-k`, `bounded`,
// `multikb` and `auto`.
struct BudgetOptions {
  // The memory budget: bytes of all buffers of the technique together. With 0, `bounded` takes 64 bytes per
  // pixel, `multikb` and `hybrid` take what k fragments need, `auto` takes what it needs, and the others take
  // 32 bytes per pixel (pellucid/memory_budget.h). If the budget is too small for what `bounded` and
  // `multikb` keep of every pixel, they draw the image in bands. Techniques with a tail keep to the budget in
  // each band.
  std::uint64_t bytes = 0;
  bool maps = false;  // fills RenderResult::maps, for techniques with a tail
  // For `variable-k`, also if `auto` chooses it: how slots are given out, and to which pixels.
  Allocation allocation = Allocation::water;
  ImportanceOptions importance{};
};

// How fragments of the same pixel are kept apart when they are shaded at the same time, in techniques with
// TechniqueInfo::syncs. All ways capture the same fragments if k is the same; for techniques with a memory
// budget, k can depend on the way.
enum class Sync {
  automatic,  // the first of TechniqueInfo::syncs that the device supports and that, for `kb`, fits k
  atomics,    // chains of 64-bit minima: any k, two geometry passes
  ordered,    // attachments that are read back in draw order; their number limits k
  interlock,  // critical sections: any k
  atomics32,  // chains of 32-bit minima, first of depths, then of ids; every device supports them
  spinlock    // critical sections with a lock that is tried KBufferOptions::lock_turns times
};
struct NamedSync {
  Sync sync;
  std::string name;
};
// Returns all ways except `automatic`. Those that are fastest at pure insertion come first.
std::span<const NamedSync> sync_ways();
// Returns what `device` lacks for a way, or an empty text if it supports the way.
std::string missing_for(Sync sync, const DeviceInfo& device);

// Options of k-buffers: `kb`, `fixed-k`, `hybrid`, `k-plus`, `variable-k`.
struct KBufferOptions {
  Sync sync = Sync::automatic;
  // For `k-plus` and `variable-k` in critical sections: pixels with this number of slots or more keep them as
  // a heap, others as an array. The paper uses 16.
  std::uint32_t heap_from = 16;
  // For Sync::spinlock: how many times a fragment tries to get the lock. Then it goes to the tail and is
  // counted as overflowed.
  std::uint32_t lock_turns = 1024;
};

// Options of techniques that peel with the depth test or from both ends.
struct PeelingOptions {
  bool cull = false;  // do not draw triangles again that are peeled completely
};

struct RenderOptions {
  std::string technique = "sb";
  Effect effect = Effect::transparency;
  CsgOperation csg = CsgOperation::union_of_all;  // for Effect::csg
  Vec3f background{1, 1, 1};                      // linear
  Vec3f edge_color{0.02F, 0.02F, 0.03F};          // linear; for Effect::wireframe
  // Fragments, samples or buckets per pixel, for techniques with a fixed number of them; 1 .. 64.
  std::uint32_t k = 8;
  // Samples per pixel: 1, or 4 at the standard positions of Vulkan. Until the image is averaged, each sample
  // is treated as a pixel of its own, with its own shading, depth and fragments. Edges are therefore right
  // also where surfaces intersect or coincide. All triangles are drawn once per sample.
  std::uint32_t samples = 1;
  PoolOptions pool{};
  BudgetOptions budget{};
  KBufferOptions k_buffer{};
  PeelingOptions peeling{};
  // Sorts lists by insertion into a local array, which is the usual way, for comparison.
  bool plain_resolve = false;
  // Counts what is captured and how much of it is coplanar. Without it, CaptureStats has neither, and sorting
  // kernels finish a pixel as soon as nothing behind can be seen.
  bool statistics = true;
  bool keep_fragments = false;  // fills RenderResult::fragments; draws everything twice
};

// ----------------------------------------------------------------------------------------------- techniques

// Parts of RenderOptions that only some techniques use. They have no effect on other techniques.
enum class OptionGroup {
  k,                  // RenderOptions::k
  pool,               // PoolOptions::nodes
  overflow,           // PoolOptions::overflow
  budget,             // BudgetOptions::bytes
  maps,               // BudgetOptions::maps
  importance,         // BudgetOptions::allocation and importance
  sync,               // KBufferOptions::sync
  critical_sections,  // KBufferOptions::heap_from and lock_turns
  culling,            // PeelingOptions
  sorting             // RenderOptions::plain_resolve
};

struct TechniqueInfo {
  std::string name;                   // "f2b-2p"
  std::string title;                  // "front-to-back peeling, two coplanar fragments a round"
  std::string paper;                  // its source
  bool exact = true;                  // captures every fragment, including coplanar ones, if memory suffices
  bool order_free = true;             // captures the same fragments for every draw order
  std::string captures;               // what it captures, if it is not exact
  std::string passes_formula;         // D: depth layers; C: fragments of a layer; N: fragments of a pixel
  std::string bytes_formula;          // per pixel
  std::vector<OptionGroup> groups{};  // the options that it uses
  // The allowed values of KBufferOptions::sync, the preferred one first. Empty: there is no choice, and
  // atomics are used if necessary.
  std::vector<Sync> syncs{};
  bool pooled = false;  // all fragments of the image are in the pool at the same time
  // Averages what does not fit behind what it keeps. For transparency and wireframe only.
  bool keeps_tail = false;
  bool blends_only =
      false;  // delivers no fragments: only for transparency and wireframe, without keep_fragments
  bool needs_atomics64 = false, needs_layered = false;
  std::uint32_t needs_ordered = 0;  // least number of DeviceInfo::ordered_attachments

  [[nodiscard]] bool uses(OptionGroup group) const {
    return std::find(groups.begin(), groups.end(), group) != groups.end();
  }
};
// Returns the techniques in the order of Table 1 of the paper, and none if pellucid was built without Vulkan.
std::span<const TechniqueInfo> render_techniques();
// Returns what `device` lacks for a technique, or an empty text if it supports the technique.
std::string missing_for(const TechniqueInfo& technique, const DeviceInfo& device);

}  // namespace pellucid
