// Counts the overdraw of orders of patches on stored layer lists, and improves the orders by sifting. In:
// layer lists and ranks. Out: excess overdraw by view and order, and better ranks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "overdraw/layer_lists.h"
#include "sequencing/k_orders.h"
#include "sequencing/linear_order.h"

namespace pellucid {

// Returns the number of fragments of a list that are shaded in an order (rank by patch), at least 1.
std::uint32_t shaded_layers(std::span<const Layer> list, std::span<const std::uint32_t> ranks);

// Returns the excess overdraw of every view under every order: views x orders, row by row.
std::vector<double> overdraw_table(const LayerLists& lists,
                                   const std::vector<std::vector<std::uint32_t>>& ranks);

// A list and its weight: the number of its pixels, summed over the views of a cluster. All views count the
// same.
struct WeightedList {
  std::uint32_t list;
  std::int64_t weight;
};
// The weight of an excess overdraw of 1 in one view.
constexpr std::int64_t kOverdrawUnit = std::int64_t{1} << 24U;
std::vector<WeightedList> weigh_lists(const LayerLists& lists, std::span<const std::uint32_t> views);
// Returns the excess overdraw in kOverdrawUnit, summed over the views.
std::int64_t excess_of(const ListPool& pool, std::span<const WeightedList> weighted,
                       std::span<const std::uint32_t> ranks);

// Computes the pairwise preferences of patches, one row at a time. A weight is the exact change of the number
// of shaded fragments when the patch passes that neighbour and nothing else moves. A fragment of the patch is
// shaded as long as the patch comes before everything nearer. A fragment behind it that comes before
// everything else nearer is shaded in addition once the patch comes later than it.
class LayerRows {
 public:
  // Patches stay inside their part: `ranks` keep the patches of each part together.
  LayerRows(const ListPool& pool, std::span<const WeightedList> weighted,
            std::span<const std::uint32_t> patch_parts, std::span<const std::uint32_t> ranks);

  PreferenceRow row(NodeId patch, std::span<const double> positions);
  [[nodiscard]] std::pair<double, double> free_range(NodeId patch) const {
    return free_ranges_[patch_parts_[patch]];
  }

 private:
  void gather(std::span<const Layer> list, NodeId patch, std::int64_t weight,
              std::span<const double> positions);
  void add(NodeId neighbor, std::int64_t weight);

  const ListPool& pool_;
  std::span<const WeightedList> weighted_;
  std::span<const std::uint32_t> patch_parts_;
  std::vector<std::pair<double, double>>
      free_ranges_;                      // by part: the ranks between which its patches may move
  std::vector<std::uint64_t> offsets_;   // patches + 1
  std::vector<std::uint32_t> lists_of_;  // indices into weighted_, by patch
  std::vector<std::int64_t> sums_;       // by patch, of the current row
  std::vector<std::uint8_t> met_;
  std::vector<NodeId> neighbors_;
  std::vector<float> weights_;
};

// The centroids of patches, by patch and pose.
class PatchCentroids {
 public:
  PatchCentroids(const OverdrawSubject& subject, const Patches& patches);
  [[nodiscard]] const Vec3f& at(std::uint32_t frame, std::uint32_t patch) const {
    return centroids_[std::size_t{frame} * patches_ + patch];
  }
  [[nodiscard]] std::uint32_t patch_count() const { return patches_; }

 private:
  std::uint32_t patches_;
  std::vector<Vec3f> centroids_;
};

// Returns the paper's d(p), section 3.2: for every patch its distances to the eye, summed over views.
std::vector<double> summed_distances(const PatchCentroids& centroids, std::span<const OverdrawView> views,
                                     std::span<const std::uint32_t> chosen,
                                     std::span<const BoundingSphere> spheres);

// Returns the ranks of patches by key. Parts are sorted by the mean key of their patches.
std::vector<std::uint32_t> ranks_by_part(std::span<const double> keys,
                                         std::span<const std::uint32_t> patch_parts);

struct SiftLayersOptions {
  std::uint32_t sweeps = 10;
  double least_gain = 0.01;  // share of the excess that a sweep must save
  Progress* progress = nullptr;
};
// Improves ranks for some views: first the order of the parts, then the order of the patches in each part.
// The result is never worse.
void sift_layers(const LayerLists& lists, std::span<const std::uint32_t> views,
                 std::span<const std::uint32_t> patch_parts, const SiftLayersOptions& options,
                 std::vector<std::uint32_t>& ranks);

// Returns the costs that improve_orders() minimises.
OrderCosts measured_overdraw(const LayerLists& lists, std::span<const std::uint32_t> patch_parts,
                             const SiftLayersOptions& options);

}  // namespace pellucid
