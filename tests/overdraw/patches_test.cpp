// Tests patches: cutting, joining, cache walks, and the savings that single triangles still allow.
#include "overdraw/patches.h"

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "overdraw/merge_patches.h"
#include "overdraw_helpers.h"
#include "pellucid/metric.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

std::vector<std::uint32_t> indices_of(const std::vector<Triangle>& triangles,
                                      const std::vector<std::uint32_t>& sequence) {
  std::vector<std::uint32_t> indices;
  for (const std::uint32_t t : sequence)
    indices.insert(indices.end(), triangles[t].begin(), triangles[t].end());
  return indices;
}

std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> sequence(count);
  std::iota(sequence.begin(), sequence.end(), 0U);
  return sequence;
}

// Triangles of random corners, some of them equal.
std::vector<Triangle> random_triangles(std::size_t count, std::uint32_t vertices, Random& random) {
  std::vector<Triangle> triangles(count);
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) corner = static_cast<std::uint32_t>(random.below(vertices));
  }
  return triangles;
}

// ---------------------------------------------------------------------------------------------- misses

TEST(CacheMisses, AreThoseOfTheSimulation) {
  Random random(1);
  for (int trial = 0; trial < 30; ++trial) {
    const auto vertices = static_cast<std::uint32_t>(3 + random.below(60));
    const std::vector<Triangle> triangles = random_triangles(200, vertices, random);
    const std::vector<std::uint32_t> sequence = testing::random_ranks(200, random);
    for (const std::uint32_t size : {3U, 5U, 16U, 64U}) {
      const std::uint64_t misses = cache_misses(triangles, sequence, vertices, size);
      const std::vector<std::uint32_t> indices = indices_of(triangles, sequence);
      EXPECT_EQ(misses, simulate_vertex_cache(indices, vertices, CacheModel::fifo, size).misses);
      EXPECT_EQ(misses, testing::queue_misses(triangles, sequence, size));
    }
  }
  EXPECT_EQ(cache_misses({}, {}, 0, 16), 0U);
}

TEST(AcmrOf, IsTheMeanOverOrders) {
  const OverdrawSubject subject = testing::subject_of(testing::icosphere_mesh(1));
  Random random(3);
  const std::vector<std::vector<std::uint32_t>> orders{identity(80), testing::random_ranks(80, random)};
  double expected = 0;
  for (const auto& order : orders)
    expected += static_cast<double>(testing::queue_misses(subject.triangles, order, 16)) / 160.0;
  EXPECT_NEAR(acmr_of(subject, orders, 16), expected, 1e-12);
}

// ------------------------------------------------------------------------------------------------- cuts

// Every cut has a reason, and none is missing.
void expect_cut_where_due(const OverdrawSubject& subject, const std::vector<std::uint32_t>& sequence,
                          double lambda, std::uint32_t cache_size) {
  const Patches patches = cut_patches(subject, sequence, lambda, cache_size);
  const std::vector<std::uint32_t> parts = part_of_triangles(subject);
  EXPECT_EQ(patches.sequence, sequence);
  ASSERT_EQ(patches.offsets.size(), patches.count() + std::size_t{1});
  EXPECT_EQ(patches.offsets.front(), 0U);
  EXPECT_EQ(patches.offsets.back(), sequence.size());
  EXPECT_TRUE(std::is_sorted(patches.parts.begin(), patches.parts.end()));
  const PatchPlaces places = places_of(patches);
  for (std::uint32_t i = 0; i < sequence.size(); ++i) EXPECT_EQ(places.place_of[sequence[i]], i);
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    const auto own = patches.triangles_of(patch);
    ASSERT_FALSE(own.empty());
    testing::QueueCache cache(cache_size);
    std::uint32_t misses = 0;
    bool full = false;
    for (std::uint32_t i = 0; i < own.size(); ++i) {
      EXPECT_EQ(parts[own[i]], patches.parts[patch]);
      EXPECT_EQ(places.patch_of[own[i]], patch);
      EXPECT_FALSE(full) << "patch " << patch << " should have ended";
      const std::uint32_t missed = cache.draw(subject.triangles[own[i]]);
      EXPECT_TRUE(i == 0 || missed < 3) << "patch " << patch << " could have been cut for nothing";
      misses += missed;
      full = lambda >= 3 || misses < lambda * (i + 1);
    }
    const std::uint32_t end = patches.offsets[patch + 1];
    const bool last = end == sequence.size() || parts[sequence[end]] != patches.parts[patch];
    const bool cut_for_nothing = !last && cache.draw(subject.triangles[sequence[end]]) == 3;
    EXPECT_TRUE(full || last || cut_for_nothing) << patch;
  }
}

TEST(CutPatches, EndWhereTheyAreWorthIt) {
  const OverdrawSubject shells = testing::subject_of(testing::nested_spheres(2));
  const OverdrawSubject parts =
      testing::subject_of({testing::icosphere_mesh(2), testing::random_soup(20, 1, 3),
                           testing::icosphere_mesh(1), testing::icosphere_mesh(0)});
  const OverdrawSubject knot = testing::sample_subject("torus-knot", 0.1, 1000);
  Random random(5);
  for (const OverdrawSubject* subject : {&shells, &parts, &knot}) {
    for (const double lambda : {0.7, 0.85, 1.2, 1.6, 2.5, 3.0, 9.0}) {
      for (const std::uint32_t size : {4U, 16U}) {
        expect_cut_where_due(*subject, cache_order(*subject, size), lambda, size);
        expect_cut_where_due(*subject, identity(subject->triangles.size()), lambda, size);
      }
    }
  }
  OverdrawSubject tangle;
  tangle.triangles = random_triangles(150, 20, random);
  tangle.frames = {std::vector<Vec3f>(20)};
  tangle.parts = {0, 70, 70, 71};
  expect_cut_where_due(tangle, identity(150), 1.1, 8);
}

TEST(CutPatches, LambdaThreeAndUnindexedMeshesGiveSingleTriangles) {
  const OverdrawSubject sphere = testing::subject_of(testing::icosphere_mesh(1));
  EXPECT_EQ(cut_patches(sphere, cache_order(sphere, 16), 3, 16).count(), 80U);
  const OverdrawSubject soup = testing::subject_of(testing::random_soup(33, 1, 3));
  EXPECT_EQ(cut_patches(soup, cache_order(soup, 16), 0.85, 16).count(), 33U);
}

TEST(JoinPatches, KeepTheSequence) {
  const OverdrawSubject subject =
      testing::subject_of({testing::icosphere_mesh(1), testing::icosphere_mesh(1)});
  const Patches patches = cut_patches(subject, cache_order(subject, 16), 1.5, 16);
  Random random(3);
  std::vector<std::uint8_t> join(patches.count(), 0);
  for (std::uint32_t i = 0; i + 1 < patches.count(); ++i)
    join[i] = patches.parts[i] == patches.parts[i + 1] && random.below(2) == 0 ? 1 : 0;
  const JoinedPatches joined = join_patches(patches, join);
  EXPECT_EQ(joined.patches.sequence, patches.sequence);
  EXPECT_EQ(joined.patches.offsets.back(), patches.sequence.size());
  ASSERT_EQ(joined.patch_of.size(), patches.count());
  const PatchPlaces before = places_of(patches);
  const PatchPlaces after = places_of(joined.patches);
  for (std::size_t t = 0; t < subject.triangles.size(); ++t)
    EXPECT_EQ(after.patch_of[t], joined.patch_of[before.patch_of[t]]);
  for (std::uint32_t i = 0; i + 1 < patches.count(); ++i)
    EXPECT_EQ(joined.patch_of[i + 1], joined.patch_of[i] + (join[i] != 0 ? 0 : 1));
  for (std::uint32_t i = 0; i < patches.count(); ++i)
    EXPECT_EQ(joined.patches.parts[joined.patch_of[i]], patches.parts[i]);
}

// ------------------------------------------------------------------------------------------------ walks

TEST(CacheOrders, ArePermutationsWithFewMisses) {
  for (const SampleInfo& sample : sample_list()) {
    const OverdrawSubject subject = testing::sample_subject(sample.name, 0.2, 2000);
    const auto vertices = static_cast<std::uint32_t>(subject.frames.front().size());
    std::vector<std::uint32_t> theirs(3 * subject.triangles.size());
    const std::vector<std::uint32_t> indices =
        indices_of(subject.triangles, identity(subject.triangles.size()));
    meshopt_optimizeVertexCacheFifo(theirs.data(), indices.data(), indices.size(), vertices, 16);
    const auto bound =
        static_cast<double>(simulate_vertex_cache(theirs, vertices, CacheModel::fifo, 16).misses);
    const std::vector<std::uint32_t> plain = cache_order(subject, 16);
    const std::vector<std::uint32_t> best = best_cache_order(subject, 16, 1);
    EXPECT_TRUE(testing::is_permutation_of_all(plain));
    EXPECT_TRUE(testing::is_permutation_of_all(best));
    const auto misses_of = [&](const std::vector<std::uint32_t>& sequence) {
      return static_cast<double>(cache_misses(subject.triangles, sequence, vertices, 16));
    };
    EXPECT_LE(misses_of(plain), 1.05 * bound) << sample.name;
    EXPECT_LE(misses_of(best), 1.03 * bound) << sample.name;
    EXPECT_LE(misses_of(best), misses_of(plain)) << sample.name;
  }
}

TEST(CacheOrders, KeepPartsInTheirSequence) {
  OverdrawSubject subject = testing::subject_of(
      {testing::icosphere_mesh(1), testing::random_soup(10, 1, 3), testing::icosphere_mesh(2)});
  subject.parts = {0, 80, 80, 90, 410};  // one is empty, and the last
  const std::vector<std::uint32_t> parts = part_of_triangles(subject);
  EXPECT_EQ(parts[80], 2U);
  for (const auto& sequence : {cache_order(subject, 16), best_cache_order(subject, 16, 1)}) {
    ASSERT_EQ(sequence.size(), 410U);
    EXPECT_TRUE(testing::is_permutation_of_all(sequence));
    for (std::size_t i = 1; i < sequence.size(); ++i) EXPECT_LE(parts[sequence[i - 1]], parts[sequence[i]]);
  }
}

class Stop : public Progress {
 public:
  void begin(std::string_view /*name*/, std::uint64_t /*total*/) override {}
  void advance(std::uint64_t /*amount*/) override {}
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(CacheOrders, StopWhenAskedTo) {
  const OverdrawSubject subject = testing::subject_of({testing::icosphere_mesh(2)});
  const Stop stop;
  EXPECT_THROW(best_cache_order(subject, 16, 1, &stop), Error);
}

// ------------------------------------------------------------------------------------------------ merge

struct MergeCase {
  OverdrawSubject subject;
  OrderedPatches ordered;
};

MergeCase merge_case(OverdrawSubject subject, std::uint32_t orders, double lambda) {
  MergeCase made{std::move(subject), {}};
  const OverdrawSubject& s = made.subject;
  Patches patches = cut_patches(s, best_cache_order(s, 16, 1), lambda, 16);
  const std::vector<OverdrawView> views = testing::random_views(s, 12, 3);
  made.ordered.lists = list_layers(s, pose_spheres(s), patches, views, {48, 1, nullptr});
  made.ordered.patches = std::move(patches);
  Random random(5);
  Clustering& clustering = made.ordered.clustering;
  for (std::size_t v = 0; v < views.size(); ++v)
    clustering.cluster_of.push_back(static_cast<std::uint32_t>(v % orders));
  for (std::uint32_t i = 0; i < orders; ++i)
    clustering.ranks.push_back(testing::random_part_ranks(made.ordered.patches.parts, random));
  clustering = improve_orders(measured_overdraw(made.ordered.lists, made.ordered.patches.parts, {}),
                              std::move(clustering), {3, 0})
                   .clustering;
  return made;
}

void expect_merged(const MergeCase& before, double acmr) {
  OrderedPatches after = before.ordered;
  MergeOptions options;
  options.acmr = acmr;
  const std::vector<std::uint32_t> patch_of = merge_patches(before.subject, options, after);
  EXPECT_EQ(after.patches.sequence, before.ordered.patches.sequence);
  ASSERT_EQ(patch_of.size(), before.ordered.patches.count());
  const PatchPlaces old_places = places_of(before.ordered.patches);
  const PatchPlaces new_places = places_of(after.patches);
  for (std::size_t t = 0; t < old_places.patch_of.size(); ++t)
    EXPECT_EQ(new_places.patch_of[t], patch_of[old_places.patch_of[t]]);
  const std::vector<std::uint32_t> parts = part_of_triangles(before.subject);
  for (std::size_t t = 0; t < parts.size(); ++t)
    EXPECT_EQ(after.patches.parts[new_places.patch_of[t]], parts[t]);
  for (const auto& ranks : after.clustering.ranks) {
    EXPECT_TRUE(testing::is_permutation_of_all(ranks));
    EXPECT_EQ(ranks.size(), after.patches.count());
    EXPECT_TRUE(testing::parts_stay_together(sequence_of(ranks), after.patches.parts));
  }
  const double start = mean_acmr(before.subject, before.ordered.patches, before.ordered.clustering.ranks, 16);
  const double end = mean_acmr(before.subject, after.patches, after.clustering.ranks, 16);
  EXPECT_LE(end, start);
  // The lists are those of the joined patches, and the clustering knows what its orders cost.
  const std::vector<double> table = overdraw_table(after.lists, after.clustering.ranks);
  const LayerLists anew = list_layers(before.subject, pose_spheres(before.subject), after.patches,
                                      testing::random_views(before.subject, 12, 3), {48, 1, nullptr});
  EXPECT_EQ(table, overdraw_table(anew, after.clustering.ranks));
  if (end <= acmr) return;
  // Else no patch has a successor that would save a miss.
  for (std::uint32_t patch = 0; patch + 1 < after.patches.count(); ++patch) {
    if (after.patches.parts[patch] != after.patches.parts[patch + 1]) continue;
    const auto first = after.patches.triangles_of(patch);
    const auto second = after.patches.triangles_of(patch + 1);
    std::vector<std::uint32_t> both(first.begin(), first.end());
    both.insert(both.end(), second.begin(), second.end());
    const std::vector<Triangle>& triangles = before.subject.triangles;
    EXPECT_EQ(testing::queue_misses(triangles, both, 16),
              testing::queue_misses(triangles, {first.begin(), first.end()}, 16) +
                  testing::queue_misses(triangles, {second.begin(), second.end()}, 16));
  }
}

TEST(MergePatches, ReachTheMissesAskedForOrNothingIsLeftToJoin) {
  const MergeCase shells = merge_case(testing::subject_of(testing::nested_spheres(2)), 2, 1.6);
  const MergeCase parts = merge_case(testing::passing_spheres(2, 2), 3, 3);
  for (const MergeCase* made : {&shells, &parts}) {
    const double start = mean_acmr(made->subject, made->ordered.patches, made->ordered.clustering.ranks, 16);
    for (const double acmr : {start, 0.9 * start, 0.7 * start, 0.75}) {
      OrderedPatches after = made->ordered;
      MergeOptions options;
      options.acmr = acmr;
      merge_patches(made->subject, options, after);
      EXPECT_LE(mean_acmr(made->subject, after.patches, after.clustering.ranks, 16), acmr);
    }
    expect_merged(*made, 0.8 * start);
    expect_merged(*made, 0);
  }
  const MergeCase soup = merge_case(testing::subject_of(testing::random_soup(30, 0.5, 3)), 2, 1.6);
  expect_merged(soup, 0.5);
}

}  // namespace
}  // namespace pellucid
