// Implements layer_lists.h: rasterises views and collects the distinct lists of the patches at their pixels.
#include "overdraw/layer_lists.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace pellucid {
namespace {

constexpr std::size_t kViewsPerBlock = 256;

std::uint64_t hash_of(std::span<const Layer> list) {
  std::uint64_t hash = 0x9E3779B97F4A7C15ULL * (list.size() + 1);
  for (const Layer layer : list) {
    hash = (hash ^ layer) * 0xFF51AFD7ED558CCDULL;
    hash ^= hash >> 32U;
  }
  return hash;
}

// Returns whether a pixel belongs to the random `share` of all pixels.
bool chosen(std::uint64_t pixel, std::uint64_t view, double share) {
  return Random((view << 32U) + pixel).uniform() < share;
}

// The lists of one view, or of the work of one thread.
struct LocalLists {
  ListPool pool;
  std::vector<std::uint32_t> pixels;  // by list
  std::uint64_t covered = 0;
};

// Turns fragments into layers.
class LayerMaker {
 public:
  explicit LayerMaker(const PatchPlaces& places) : places_(places) {}

  std::span<const Layer> make(std::span<const Fragment> fragments) {
    layers_.clear();
    order_.clear();
    float depth = -1;
    for (const Fragment& fragment : fragments) {
      const std::uint32_t triangle = fragment.node / 2;
      layers_.push_back(places_.patch_of[triangle] | (fragment.depth == depth ? kTieBit : 0));
      order_.push_back(places_.place_of[triangle]);
      depth = fragment.depth;
    }
    drop_hidden(layers_, order_);
    return layers_;
  }

 private:
  const PatchPlaces& places_;
  std::vector<Layer> layers_;
  std::vector<std::uint32_t> order_;
};

void add_to(LocalLists& lists, std::span<const Layer> list, std::uint32_t pixels) {
  if (list.size() < 2) return;
  const std::uint32_t number = lists.pool.number_of(list);
  if (number == lists.pixels.size()) lists.pixels.push_back(0);
  lists.pixels[number] += pixels;
}

}  // namespace

void drop_hidden(std::vector<Layer>& layers, std::vector<std::uint32_t>& places) {
  std::size_t kept = 0;
  bool first_of_group = true;  // nothing of this depth was kept so far
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (!is_tied(layers[i])) first_of_group = true;
    const std::uint32_t patch = patch_of_layer(layers[i]);
    bool hidden = false;
    for (std::size_t j = 0; j < kept && !hidden; ++j) {
      if (patch_of_layer(layers[j]) != patch) continue;
      if (places[j] < places[i]) {
        hidden = true;
      } else {
        // Of fragments at one depth only the first drawn one passes, so that only the earliest place counts.
        bool same_depth = !first_of_group;
        for (std::size_t k = j + 1; k < kept && same_depth; ++k) same_depth = is_tied(layers[k]);
        if (!same_depth) continue;
        places[j] = places[i];
        hidden = true;
      }
    }
    if (hidden) continue;
    layers[kept] = first_of_group ? patch : patch | kTieBit;
    places[kept] = places[i];
    ++kept;
    first_of_group = false;
  }
  layers.resize(kept);
  places.resize(kept);
}

// ------------------------------------------------------------------------------------------------- pool

void ListPool::clear() {
  offsets_.assign(1, 0);
  layers_.clear();
  std::fill(slots_.begin(), slots_.end(), 0);
}

std::size_t ListPool::slot_of(std::span<const Layer> list) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash_of(list) & mask;
  while (slots_[slot] != 0) {
    const std::span<const Layer> known = this->list(slots_[slot] - 1);
    if (std::equal(known.begin(), known.end(), list.begin(), list.end())) break;
    slot = (slot + 1) & mask;
  }
  return slot;
}

void ListPool::grow() {
  slots_.assign(std::max<std::size_t>(1024, 2 * slots_.size()), 0);
  for (std::uint32_t number = 0; number < count(); ++number) slots_[slot_of(list(number))] = number + 1;
}

std::uint32_t ListPool::number_of(std::span<const Layer> list) {
  if (2 * (std::size_t{count()} + 1) > slots_.size()) grow();
  std::uint32_t& slot = slots_[slot_of(list)];
  if (slot != 0) return slot - 1;
  layers_.insert(layers_.end(), list.begin(), list.end());
  offsets_.push_back(layers_.size());
  slot = count();
  return slot - 1;
}

LayerLists list_layers(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres,
                       const Patches& patches, std::span<const OverdrawView> views,
                       const ListOptions& options) {
  const PatchPlaces places = places_of(patches);
  PerThread<PoseRaster> rasters([&] { return PoseRaster(subject, spheres, options.size); });
  PerThread<LayerMaker> makers([&] { return LayerMaker(places); });
  LayerLists lists;
  // Blocks of views are processed in parallel. Their lists are numbered view by view.
  for (std::size_t begin = 0; begin < views.size(); begin += kViewsPerBlock) {
    const std::size_t count = std::min(kViewsPerBlock, views.size() - begin);
    std::vector<LocalLists> block(count);
    parallel_loop(std::size_t{0}, count, [&](std::size_t i) {
      stop_if_requested(options.progress);
      LocalLists& local = block[i];
      LayerMaker& maker = makers.local();
      rasters.local().draw(views[begin + i], [&](std::uint64_t pixel, std::span<const Fragment> fragments) {
        if (options.share < 1 && !chosen(pixel, begin + i, options.share)) return;
        ++local.covered;
        add_to(local, maker.make(fragments), 1);
      });
      advance_stage(options.progress, 1);
    });
    for (LocalLists& local : block) {
      for (std::uint32_t i = 0; i < local.pool.count(); ++i)
        lists.uses.push_back({lists.pool.number_of(local.pool.list(i)), local.pixels[i]});
      lists.offsets.push_back(lists.uses.size());
      lists.covered.push_back(local.covered);
      local = {};
    }
  }
  return lists;
}

namespace {

// Makes lists of other items. rename(item) returns the new item and the place of the old item in it.
template <class Rename>
LayerLists renamed_lists(const LayerLists& lists, const Rename& rename) {
  constexpr std::uint32_t kNoList = std::numeric_limits<std::uint32_t>::max();
  LayerLists renamed;
  std::vector<std::uint32_t> new_number(lists.pool.count());
  std::vector<Layer> layers;
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < lists.pool.count(); ++i) {
    layers.clear();
    places.clear();
    for (const Layer layer : lists.pool.list(i)) {
      const auto [item, place] = rename(patch_of_layer(layer));
      layers.push_back(item | (layer & kTieBit));
      places.push_back(place);
    }
    drop_hidden(layers, places);
    new_number[i] = layers.size() < 2 ? kNoList : renamed.pool.number_of(layers);
  }
  renamed.covered = lists.covered;
  std::vector<std::uint32_t> pixels(renamed.pool.count(), 0);
  std::vector<std::uint32_t> used;
  for (std::uint32_t view = 0; view < lists.view_count(); ++view) {
    used.clear();
    for (const ListUse& use : lists.uses_of(view)) {
      const std::uint32_t number = new_number[use.list];
      if (number == kNoList) continue;
      if (pixels[number] == 0) used.push_back(number);
      pixels[number] += use.pixels;
    }
    for (const std::uint32_t number : used) {
      renamed.uses.push_back({number, pixels[number]});
      pixels[number] = 0;
    }
    renamed.offsets.push_back(renamed.uses.size());
  }
  return renamed;
}

}  // namespace

LayerLists joined_lists(const LayerLists& lists, std::span<const std::uint32_t> patch_of) {
  // The members of a patch are drawn by number.
  return renamed_lists(lists, [&](std::uint32_t patch) { return std::pair(patch_of[patch], patch); });
}

LayerLists lists_of_patches(const LayerLists& lists, const PatchPlaces& places) {
  return renamed_lists(lists, [&](std::uint32_t triangle) {
    return std::pair(places.patch_of[triangle], places.place_of[triangle]);
  });
}

LayerLists lists_of_views(const LayerLists& lists, std::span<const std::uint32_t> views) {
  LayerLists some;
  for (const std::uint32_t view : views) {
    for (const ListUse& use : lists.uses_of(view))
      some.uses.push_back({some.pool.number_of(lists.pool.list(use.list)), use.pixels});
    some.offsets.push_back(some.uses.size());
    some.covered.push_back(lists.covered[view]);
  }
  return some;
}

}  // namespace pellucid
