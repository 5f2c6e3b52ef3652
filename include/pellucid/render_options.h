// pellucid/render_options.h - module `render`: effects, capture techniques, and the options of drawing.
//
// A capture technique delivers fragments of every pixel, an effect folds them into a colour. TechniqueInfo
// says what a technique keeps, what it costs and which options it uses. Paper: Vasilakis, Fudos,
// "Depth-Fighting Aware Methods for Multi-Fragment Rendering", TVCG 2014.
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
  wireframe,       // the same, with opaque edges: hidden ones show through translucent faces
  csg,             // union, intersection or difference of closed solids, at most 32
  self_collision,  // where an object intersects itself, in red; at most 8 objects
  coplanarity,     // the largest group of fragments at one depth, in the paper's colours
  complexity,      // the number of fragments of a pixel
  thickness,       // the length of the way of light through closed solids
};
// Difference: the first object minus all others.
enum class CsgOperation { union_of_all, intersection, difference };

struct NamedEffect {
  Effect effect;
  std::string name, description;
};
std::span<const NamedEffect> render_effects();

// -------------------------------------------------------------------------------------------------- options

// What becomes of fragments that a pool or a memory budget has no room for. It needs 64-bit atomics.
enum class Overflow {
  // The nearest fragments of every pixel are kept, in all as many as the pool has nodes. The others are
  // counted
  // and, where the effect blends, shown behind them as one layer of their weighted average colour with the
  // product of their transmittances.
  nearest,
  // All fragments are captured, in as many rounds as necessary: `multikb` in the pool.
  exact
};

// Options of techniques that store their fragments in a pool of nodes: `sb`, `ll`, `bun-ll`, and for the
// fragments of a layer `f2b-ll` and `dual-ll`.
struct PoolOptions {
  std::uint64_t nodes = 0;  // 0: as many as there are fragments
  // What is done where there are more fragments than nodes. `auto` applies it to BudgetOptions::bytes.
  Overflow overflow = Overflow::nearest;
};

// Options of techniques with a memory budget: `fixed-k`, `hybrid`, `k-plus`, `variable-k`, `bounded`,
// `multikb` and `auto`.
struct BudgetOptions {
  // Bytes of all buffers of the technique. 0: `bounded` takes 64 a pixel, `multikb` and `hybrid` as many as
  // hold k fragments, `auto` as many as it needs, the others 32 a pixel (pellucid/memory_budget.h). `bounded`
  // and `multikb` draw the image in bands where that is too little for what they keep of every pixel;
  // techniques with a tail keep to it in each band.
  std::uint64_t bytes = 0;
  bool maps = false;  // RenderResult::maps, of techniques with a tail
  // Of `variable-k`, also where `auto` takes it: how it gives out slots, and to which pixels.
  Allocation allocation = Allocation::water;
  ImportanceOptions importance{};
};

// How fragments of a pixel that are shaded at the same time are kept apart, in techniques with
// TechniqueInfo::syncs. What is captured is the same in all ways, of techniques with a memory budget as long
// as k is.
enum class Sync {
  automatic,  // the first of TechniqueInfo::syncs that the device supports; for `kb`, that also fits k
  atomics,    // chains of 64-bit minima: any k, two geometry passes
  ordered,    // attachments that are read back in draw order; their number limits k and memory
  interlock,  // critical sections: any k
  atomics32,  // chains of 32-bit minima, of depths and then of ids, which every device supports
  spinlock    // critical sections behind a word that is tried KBufferOptions::lock_turns times
};
struct NamedSync {
  Sync sync;
  std::string name;
};
// Returns all but `automatic`, the fastest first where fragments are only inserted.
std::span<const NamedSync> sync_ways();
// Returns what `device` lacks for it; empty: nothing.
std::string missing_for(Sync sync, const DeviceInfo& device);

// Options of k-buffers: `kb`, `fixed-k`, `hybrid`, `k-plus`, `variable-k`.
struct KBufferOptions {
  Sync sync = Sync::automatic;
  // Of `k-plus` and `variable-k` in critical sections: pixels with this number of slots or more hold them as
  // a heap, others as an array. 16 in the paper.
  std::uint32_t heap_from = 16;
  // Of Sync::spinlock: how many times a fragment tries. Then it goes to the tail and is counted as
  // overflowed.
  std::uint32_t lock_turns = 1024;
};

// Options of techniques that peel with the depth test or from both ends.
struct PeelingOptions {
  bool cull = false;  // triangles that are peeled completely are not drawn again
};

struct RenderOptions {
  std::string technique = "sb";
  Effect effect = Effect::transparency;
  CsgOperation csg = CsgOperation::union_of_all;  // of Effect::csg
  Vec3f background{1, 1, 1};                      // linear
  Vec3f edge_color{0.02F, 0.02F, 0.03F};          // linear; of Effect::wireframe
  // Fragments, samples or buckets of a pixel, of techniques with a fixed number of them; 1 .. 64.
  std::uint32_t k = 8;
  // 1, or 4 at Vulkan's standard places. Each sample is a pixel of its own until the image is averaged,
  // shading, depth and fragments included, so that edges are right also where surfaces intersect and
  // coincide. Triangles are drawn once for each.
  std::uint32_t samples = 1;
  PoolOptions pool{};
  BudgetOptions budget{};
  KBufferOptions k_buffer{};
  PeelingOptions peeling{};
  // Sort lists by an insertion sort of a local array, as is common: to measure against.
  bool plain_resolve = false;
  // Count what is captured and how much of it is coplanar. Without it, CaptureStats has neither, and kernels
  // that sort leave a pixel where nothing behind can be seen.
  bool statistics = true;
  bool keep_fragments = false;  // RenderResult::fragments; draws twice
};

// ----------------------------------------------------------------------------------------------- techniques

// Parts of RenderOptions that only some techniques use. They have no effect on the others.
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
  std::string paper;                  // where it is from
  bool exact = true;                  // captures every fragment, also coplanar ones, given enough memory
  bool order_free = true;             // captures the same fragments in whatever order they are drawn
  std::string captures;               // in words, where it is not exact
  std::string passes_formula;         // D: depth layers; C: fragments of a layer; N: fragments of a pixel
  std::string bytes_formula;          // of a pixel
  std::vector<OptionGroup> groups{};  // the options that it uses
  // What KBufferOptions::sync may be, the preferred first; none: no choice, atomics where they are needed.
  std::vector<Sync> syncs{};
  bool pooled = false;  // all fragments of the image lie in the pool at the same time
  // What does not fit is averaged behind what is kept: for transparency and wireframe.
  bool keeps_tail = false;
  bool blends_only = false;  // delivers no fragments: for transparency and wireframe, without keep_fragments
  bool needs_atomics64 = false, needs_layered = false;
  std::uint32_t needs_ordered = 0;  // of DeviceInfo::ordered_attachments

  [[nodiscard]] bool uses(OptionGroup group) const {
    return std::find(groups.begin(), groups.end(), group) != groups.end();
  }
};
// Returns the techniques in the order of the paper's Table 1; none where pellucid was built without Vulkan.
std::span<const TechniqueInfo> render_techniques();
// Returns what `device` lacks for it; empty: nothing.
std::string missing_for(const TechniqueInfo& technique, const DeviceInfo& device);

}  // namespace pellucid
