// Stores the list of the patches at every pixel of every view, from front to back, each distinct list once.
// In: the poses of a subject, its patches, and views. Out: LayerLists, from which overdraw_costs.h counts
// overdraw.
//
// A fragment is shaded if and only if nothing as near or nearer was drawn before it. So the fragments that
// are shaded for a pixel are the prefix minima of the ranks of its fragments, front to back. A patch draws
// its triangles in a fixed order. Fragments that nearer and earlier triangles of the same patch hide are left
// out; the remaining fragments of a patch pass the depth test of their own patch. Pixels with a single
// fragment cost nothing and are not stored.
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

// A patch at a pixel. The highest bit is set if it has the same depth as the layer before it.
using Layer = std::uint32_t;
constexpr Layer kTieBit = 0x80000000U;
constexpr std::uint32_t patch_of_layer(Layer layer) {
  return layer & ~kTieBit;
}
constexpr bool is_tied(Layer layer) {
  return (layer & kTieBit) != 0;
}

// A pool of distinct lists, numbered in the order of their first use.
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
  std::vector<std::uint32_t> slots_;  // hash table of numbers + 1; 0: free
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
  std::uint32_t size = 256;  // of the images, pixels per side
  double share = 1;          // share of the pixels that are stored, chosen at random
  Progress* progress = nullptr;
};
// Rasterises every view once and returns its lists. Takes O(views * raster) time, and memory for the pool and
// 8 bytes per use of a list.
LayerLists list_layers(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres,
                       const Patches& patches, std::span<const OverdrawView> views,
                       const ListOptions& options);

// Returns the lists after patches were joined with their successors. `patch_of` has the new patch of every
// old patch.
LayerLists joined_lists(const LayerLists& lists, std::span<const std::uint32_t> patch_of);
// Returns the lists of patches, made from the lists of single triangles.
LayerLists lists_of_patches(const LayerLists& lists, const PatchPlaces& places);
// Returns the lists of some views.
LayerLists lists_of_views(const LayerLists& lists, std::span<const std::uint32_t> views);

// Removes the layers that are hidden by nearer and earlier drawn fragments of the same patch. `places`: the
// position of every fragment in the fixed order of its patch. Changes both.
void drop_hidden(std::vector<Layer>& layers, std::vector<std::uint32_t>& places);

}  // namespace pellucid
