// Tests orders of patches by measured overdraw: pairwise preferences and sifting against brute force.
#include "overdraw/overdraw_costs.h"

#include <gtest/gtest.h>

#include "overdraw/merge_patches.h"
#include "overdraw_helpers.h"

namespace pellucid {
namespace {

// `ranks` with one patch taken out and put in at another rank.
std::vector<std::uint32_t> moved(const std::vector<std::uint32_t>& ranks, std::uint32_t patch,
                                 std::uint32_t to) {
  std::vector<std::uint32_t> sequence = sequence_of(ranks);
  sequence.erase(sequence.begin() + ranks[patch]);
  sequence.insert(sequence.begin() + to, patch);
  return triangle_ranks(sequence);
}

std::vector<std::uint32_t> parts_of_sizes(std::initializer_list<std::uint32_t> sizes) {
  std::vector<std::uint32_t> parts;
  std::uint32_t part = 0;
  for (const std::uint32_t size : sizes) parts.insert(parts.end(), size, part++);
  return parts;
}

TEST(LayerRows, SayExactlyWhatAMoveCosts) {
  Random random(1);
  int changes = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const std::vector<std::uint32_t> parts =
        trial % 2 == 0 ? parts_of_sizes({9}) : parts_of_sizes({4, 1, 3, 2});
    const auto patches = static_cast<std::uint32_t>(parts.size());
    ListPool pool;
    std::vector<WeightedList> weighted;
    for (int i = 0; i < 25; ++i) {
      const std::vector<Layer> list = testing::random_list(patches, 12, random);
      const std::uint32_t known = pool.count();
      if (list.size() < 2 || pool.number_of(list) != known) continue;
      weighted.push_back({known, static_cast<std::int64_t>(1 + random.below(1000))});
    }
    const std::vector<std::uint32_t> ranks = testing::random_part_ranks(parts, random);
    const std::vector<double> positions(ranks.begin(), ranks.end());
    const std::int64_t before = excess_of(pool, weighted, ranks);
    LayerRows rows(pool, weighted, parts, ranks);
    for (std::uint32_t patch = 0; patch < patches; ++patch) {
      const PreferenceRow row = rows.row(patch, positions);
      const auto [first, last] = rows.free_range(patch);
      ASSERT_EQ(row.neighbors.size(), row.weights.size());
      for (const NodeId neighbor : row.neighbors) {
        EXPECT_NE(neighbor, patch);
        EXPECT_EQ(parts[neighbor], parts[patch]);
      }
      std::vector<NodeId> distinct(row.neighbors.begin(), row.neighbors.end());
      std::sort(distinct.begin(), distinct.end());
      EXPECT_EQ(std::adjacent_find(distinct.begin(), distinct.end()), distinct.end());
      for (std::uint32_t to = 0; to < patches; ++to) {
        const std::vector<std::uint32_t> after = moved(ranks, patch, to);
        // The free range contains exactly the ranks of the part.
        const bool inside = first < to && to < last;
        const auto others = [&] {
          for (std::uint32_t other = 0; other < patches; ++other) {
            if (ranks[other] == to) return parts[other];
          }
          return patches;
        }();
        ASSERT_EQ(inside, others == parts[patch]);
        if (!inside) continue;
        double expected = 0;
        for (std::size_t i = 0; i < row.neighbors.size(); ++i) {
          const std::uint32_t there = ranks[row.neighbors[i]];
          const auto weight = static_cast<double>(row.weights[i]);
          if (ranks[patch] < there && there <= to) expected += weight;
          if (to <= there && there < ranks[patch]) expected -= weight;
        }
        const auto change = static_cast<double>(excess_of(pool, weighted, after) - before);
        ASSERT_EQ(change, expected) << trial << ": " << patch << " to " << to;
        changes += change != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(changes, 1000);
}

TEST(LayerRows, PatchesOfNoListHaveNoPreferences) {
  ListPool pool;
  const std::vector<WeightedList> weighted{{pool.number_of(std::vector<Layer>{0, 2}), 5}};
  const std::vector<std::uint32_t> parts{0, 0, 0};
  const std::vector<std::uint32_t> ranks{2, 1, 0};
  LayerRows rows(pool, weighted, parts, ranks);
  const std::vector<double> positions(ranks.begin(), ranks.end());
  EXPECT_TRUE(rows.row(1, positions).neighbors.empty());
  const PreferenceRow row = rows.row(0, positions);
  ASSERT_EQ(row.neighbors.size(), 1U);
  EXPECT_EQ(row.neighbors[0], 2U);
  EXPECT_EQ(row.weights[0], 5.0F);
}

// ------------------------------------------------------------------------------------------------ sift

std::vector<std::uint32_t> all_views(const LayerLists& lists) {
  std::vector<std::uint32_t> views(lists.view_count());
  std::iota(views.begin(), views.end(), 0U);
  return views;
}

std::int64_t excess(const LayerLists& lists, const std::vector<std::uint32_t>& views,
                    const std::vector<std::uint32_t>& ranks) {
  return excess_of(lists.pool, weigh_lists(lists, views), ranks);
}

TEST(SiftLayers, NeverWorseAndPartsStayTogether) {
  Random random(7);
  int better = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const std::vector<std::uint32_t> parts =
        trial % 3 == 0 ? parts_of_sizes({40}) : parts_of_sizes({13, 1, 17, 0, 9});
    const LayerLists lists = testing::random_lists(40, 10, 5, 40, random);
    const std::vector<std::uint32_t> views =
        trial % 2 == 0 ? all_views(lists) : std::vector<std::uint32_t>{1, 3};
    const std::vector<std::uint32_t> start = testing::random_part_ranks(parts, random);
    std::vector<std::uint32_t> ranks = start;
    sift_layers(lists, views, parts, {}, ranks);
    ASSERT_TRUE(testing::is_permutation_of_all(ranks));
    EXPECT_TRUE(testing::parts_stay_together(sequence_of(ranks), parts));
    EXPECT_LE(excess(lists, views, ranks), excess(lists, views, start));
    better += excess(lists, views, ranks) < excess(lists, views, start) ? 1 : 0;
    std::vector<std::uint32_t> again = start;
    sift_layers(lists, views, parts, {}, again);
    EXPECT_EQ(again, ranks);
  }
  EXPECT_EQ(better, 30);
}

TEST(SiftLayers, MostlyFindsTheOptimumOfAFewPatches) {
  Random random(11);
  constexpr int kTrials = 120;
  int optimal = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto patches = static_cast<std::uint32_t>(3 + random.below(4));
    const LayerLists lists = testing::random_lists(patches, 6, 2, 8, random);
    const std::vector<std::uint32_t> parts(patches, 0);
    const std::vector<std::uint32_t> views = all_views(lists);
    std::vector<std::uint32_t> ranks = testing::random_ranks(patches, random);
    const std::int64_t start = excess(lists, views, ranks);
    sift_layers(lists, views, parts, {100, 0, nullptr}, ranks);
    std::vector<std::uint32_t> any(patches);
    std::iota(any.begin(), any.end(), 0U);
    std::int64_t best = start;
    do {
      best = std::min(best, excess(lists, views, any));
    } while (std::next_permutation(any.begin(), any.end()));
    const std::int64_t found = excess(lists, views, ranks);
    ASSERT_LE(best, found);
    EXPECT_LE(found, start);
    optimal += found == best ? 1 : 0;
  }
  EXPECT_GE(optimal, 105);  // 112 when this was written
}

TEST(SiftLayers, PartsGoWhereTheyHide) {
  // Part 1 lies before part 0 in every pixel.
  LayerLists lists;
  for (const auto& list : std::vector<std::vector<Layer>>{{2, 0}, {3, 1}, {2, 1}, {3, 2, 0}})
    lists.uses.push_back({lists.pool.number_of(list), 10});
  lists.offsets.push_back(lists.uses.size());
  lists.covered.push_back(50);
  const std::vector<std::uint32_t> parts{0, 0, 1, 1};
  std::vector<std::uint32_t> ranks{0, 1, 2, 3};
  sift_layers(lists, std::vector<std::uint32_t>{0}, parts, {}, ranks);
  EXPECT_EQ(overdraw_table(lists, {ranks}).front(), 0);
  EXPECT_LT(std::max(ranks[2], ranks[3]), std::min(ranks[0], ranks[1]));
  EXPECT_LT(ranks[3], ranks[2]);
}

TEST(MeasuredOverdraw, ReordersOnlyFlaggedClusters) {
  Random random(13);
  const LayerLists lists = testing::random_lists(15, 8, 6, 20, random);
  const std::vector<std::uint32_t> parts = parts_of_sizes({7, 8});
  Clustering clustering;
  clustering.cluster_of = {0, 1, 0, 1, 2, 2};
  for (int i = 0; i < 3; ++i) clustering.ranks.push_back(testing::random_part_ranks(parts, random));
  const Clustering before = clustering;
  const OrderCosts costs = measured_overdraw(lists, parts, {});
  costs.reorder({1, 0, 1}, false, clustering);
  EXPECT_EQ(clustering.ranks[1], before.ranks[1]);
  for (const std::uint32_t cluster : {0U, 2U}) {
    const std::vector<std::uint32_t> views = cells_of_cluster(clustering.cluster_of, cluster);
    EXPECT_LT(excess(lists, views, clustering.ranks[cluster]), excess(lists, views, before.ranks[cluster]));
  }
  EXPECT_EQ(costs.table(clustering.ranks), overdraw_table(lists, clustering.ranks));
  // Rounds of k-means end no worse, every view with its cheapest order.
  const KOrders end = improve_orders(costs, before, {8, 0});
  double cost = 0;
  for (std::size_t view = 0; view < 6; ++view) {
    const double* row = &end.table[view * 3];
    EXPECT_EQ(row[end.clustering.cluster_of[view]], *std::min_element(row, row + 3));
    cost += row[end.clustering.cluster_of[view]];
  }
  EXPECT_NEAR(end.clustering.cost, cost, 1e-9);
}

// ----------------------------------------------------------------------------------- orders by distance

TEST(RanksByPart, PartsByMeanKeyThenPatchesByKey) {
  const std::vector<std::uint32_t> parts{0, 0, 1, 1, 3};
  const std::vector<double> keys{5, 9, 1, 8, 6};  // means 7, 4.5, none, 6
  EXPECT_EQ(ranks_by_part(keys, parts), (std::vector<std::uint32_t>{3, 4, 0, 1, 2}));
  EXPECT_TRUE(ranks_by_part({}, {}).empty());
}

TEST(SummedDistances, AreThoseOfCentroidsToTheEyes) {
  const OverdrawSubject subject = testing::passing_spheres(1, 3);
  const Patches patches = cut_patches(subject, cache_order(subject, 16), 1.2, 16);
  const std::vector<OverdrawView> views = testing::random_views(subject, 4, 31);
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  const std::vector<std::uint32_t> chosen{0, 5, 7, 11};
  const std::vector<double> sums = summed_distances(PatchCentroids(subject, patches), views, chosen, spheres);
  ASSERT_EQ(sums.size(), patches.count());
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    double expected = 0;
    for (const std::uint32_t v : chosen) {
      Vec3d centroid;
      for (const std::uint32_t t : patches.triangles_of(patch)) {
        for (const std::uint32_t vertex : subject.triangles[t])
          centroid += to_double(subject.frames[views[v].frame][vertex]);
      }
      centroid = centroid / (3.0 * static_cast<double>(patches.triangles_of(patch).size()));
      const BoundingSphere& sphere = spheres[views[v].frame];
      const Viewpoint& viewpoint = views[v].viewpoint;
      expected +=
          length(centroid - sphere.center - viewpoint.direction * (viewpoint.distance * sphere.radius));
    }
    EXPECT_NEAR(sums[patch], expected, 1e-4);
  }
}

}  // namespace
}  // namespace pellucid
