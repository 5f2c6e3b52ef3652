// What lies behind every pixel of every view, as sequences of patches, each distinct one kept once.
//
// A fragment is shaded iff nothing as near or nearer was drawn before it, so that the fragments shaded for a
// pixel are the prefix minima of the ranks of its fragments, front to back. A patch draws its triangles in a
// fixed sequence: fragments that its own nearer and earlier ones hide are left out; what is left of one patch
// passes its own depth test. Pixels with a single fragment cost nothing and are not kept.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "metric/pose_raster.h"
#include "overdraw/patches.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"
#include "pellucid/raster.h"

namespace pellucid {

// A patch behind a pixel; the highest bit: as near as the one before it.
using Layer = std::uint32_t;
constexpr Layer kTieBit = 0x80000000U;
constexpr std::uint32_t patch_of_layer(Layer layer) {
  return layer & ~kTieBit;
}
constexpr bool is_tied(Layer layer) {
  return (layer & kTieBit) != 0;
}

// Distinct sequences, numbered in the order in which they are first met.
class ListPool {
 public:
  std::uint32_t number_of(std::span<const Layer> list);
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(offsets_.size() - 1); }
  [[nodiscard]] std::span<const Layer> list(std::uint32_t number) const {
    return std::span(layers_).subspan(offsets_[number], offsets_[number + 1] - offsets_[number]);
  }
  [[nodiscard]] std::uint64_t layer_count() const { return layers_.size(); }
  void clear();

 private:
  void grow();
  [[nodiscard]] std::size_t slot_of(std::span<const Layer> list) const;

  std::vector<std::uint64_t> offsets_{0};
  std::vector<Layer> layers_;
  std::vector<std::uint32_t> slots_;  // numbers + 1; 0: free. A power of two of them
};

struct ListUse {
  std::uint32_t list, pixels;
};

// The lists of some views.
struct LayerLists {
  ListPool pool;
  std::vector<std::uint64_t> offsets{0};  // views + 1
  std::vector<ListUse> uses;              // of every view, by list
  std::vector<std::uint64_t> covered;     // pixels of every view

  [[nodiscard]] std::uint32_t view_count() const { return static_cast<std::uint32_t>(covered.size()); }
  [[nodiscard]] std::span<const ListUse> uses_of(std::uint32_t view) const {
    return std::span(uses).subspan(offsets[view], offsets[view + 1] - offsets[view]);
  }
};

struct ListOptions {
  std::uint32_t size = 256;  // of the pictures, pixels a side
  double share = 1;          // of the pixels, chosen at random
  Progress* progress = nullptr;
};
// Rasterises every view once. O(views * raster); the pool and 8 bytes a use are what it keeps.
LayerLists list_layers(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres,
                       const Patches& patches, std::span<const OverdrawView> views,
                       const ListOptions& options);

// The lists after patches were joined with their successors: `patch_of` the old ones.
LayerLists joined_lists(const LayerLists& lists, std::span<const std::uint32_t> patch_of);
// The lists of patches from those of single triangles.
LayerLists lists_of_patches(const LayerLists& lists, const PatchPlaces& places);
// Those of some views.
LayerLists lists_of_views(const LayerLists& lists, std::span<const std::uint32_t> views);

// Drop what fragments nearer and drawn earlier, of the same patch, hide. `place` is the sequence in which
// the fragments of one patch are drawn. Both are changed.
void drop_hidden(std::vector<Layer>& layers, std::vector<std::uint32_t>& places);

}  // namespace pellucid
