// Tests compact patches: links, sets, short runs, and the patches made of them.
#include "overdraw/compact_patches.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "overdraw/compact_sets.h"
#include "overdraw/overdraw_costs.h"
#include "overdraw_helpers.h"

namespace pellucid {
namespace {

// A flat sheet of width x height squares, two triangles each.
Mesh sheet(std::uint32_t width, std::uint32_t height) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= height; ++y) {
    for (std::uint32_t x = 0; x <= width; ++x)
      mesh.positions.push_back({static_cast<float>(x), static_cast<float>(y), 0});
  }
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t a = y * (width + 1) + x;
      const std::uint32_t b = a + width + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({a + 1, b + 1, b});
    }
  }
  return mesh;
}

std::vector<OverdrawSubject> subjects() {
  OverdrawSubject degenerate = testing::passing_spheres(2, 1);
  for (std::size_t t = 0; t < degenerate.triangles.size(); t += 5)
    degenerate.triangles[t][1] = degenerate.triangles[t][0];
  // Some edges have four triangles.
  Mesh copies = testing::icosphere_mesh(1);
  copies.triangles.insert(copies.triangles.end(), copies.triangles.begin(), copies.triangles.begin() + 30);
  return {testing::subject_of(sheet(12, 9)),
          testing::subject_of({testing::nested_spheres(1), testing::random_soup(40, 0.5, 3)}), degenerate,
          testing::subject_of(copies), testing::subject_of(testing::one_triangle())};
}

std::size_t vertex_count(const OverdrawSubject& subject, const std::vector<std::uint32_t>& triangles) {
  std::set<std::uint32_t> vertices;
  for (const std::uint32_t t : triangles)
    vertices.insert(subject.triangles[t].begin(), subject.triangles[t].end());
  return vertices.size();
}

std::size_t summed_vertices(const OverdrawSubject& subject, const std::vector<std::uint32_t>& set_of) {
  std::vector<std::vector<std::uint32_t>> sets(*std::max_element(set_of.begin(), set_of.end()) + 1);
  for (std::uint32_t t = 0; t < set_of.size(); ++t) sets[set_of[t]].push_back(t);
  std::size_t sum = 0;
  for (const auto& set : sets) sum += vertex_count(subject, set);
  return sum;
}

// ----------------------------------------------------------------------------------------------- links

TEST(MeshLinks, AreThoseOfANaiveSearch) {
  for (const OverdrawSubject& subject : subjects()) {
    const MeshLinks links(subject);
    const std::vector<std::uint32_t> parts = part_of_triangles(subject);
    const auto shared = [&](std::uint32_t a, std::uint32_t b) {
      std::vector<std::uint32_t> both;
      for (const std::uint32_t v : links.corners(a)) {
        const auto other = links.corners(b);
        if (std::find(other.begin(), other.end(), v) != other.end()) both.push_back(v);
      }
      return both;
    };
    for (std::uint32_t t = 0; t < links.triangle_count(); ++t) {
      EXPECT_EQ(links.corners(t).size(), vertex_count(subject, {t}));
      // Beyond an edge lies the one other triangle of the part that has it.
      std::multiset<std::uint32_t> expected;
      const auto own = links.corners(t);
      for (std::size_t i = 0; i < own.size(); ++i) {
        for (std::size_t j = i + 1; j < own.size(); ++j) {
          std::vector<std::uint32_t> others;
          for (std::uint32_t o = 0; o < links.triangle_count(); ++o) {
            const std::vector<std::uint32_t> both = shared(t, o);
            const bool has_edge = std::count(both.begin(), both.end(), own[i]) > 0 &&
                                  std::count(both.begin(), both.end(), own[j]) > 0;
            if (o != t && has_edge && parts[o] == parts[t]) others.push_back(o);
          }
          if (others.size() == 1) expected.insert(others.front());
        }
      }
      std::multiset<std::uint32_t> found(links.across(t).begin(), links.across(t).end());
      found.erase(MeshLinks::kNone);
      EXPECT_EQ(found, expected);
    }
    for (std::uint32_t v = 0; v < links.vertex_count(); ++v) {
      const auto around = links.around(v);
      EXPECT_TRUE(std::is_sorted(around.begin(), around.end()));
      for (std::uint32_t t = 0; t < links.triangle_count(); ++t) {
        const auto own = links.corners(t);
        EXPECT_EQ(std::count(around.begin(), around.end(), t), std::count(own.begin(), own.end(), v));
      }
    }
  }
}

// ------------------------------------------------------------------------------------------------ sets

TEST(CompactSets, AreOfOnePartAndNumberedByTheirFirstTriangles) {
  for (const OverdrawSubject& subject : subjects()) {
    const MeshLinks links(subject);
    const std::vector<std::uint32_t> parts = part_of_triangles(subject);
    Random random(1), same(1);
    const std::vector<std::uint32_t> set_of = compact_sets(links, 6, random);
    EXPECT_EQ(set_of, compact_sets(links, 6, same));
    ASSERT_EQ(set_of.size(), subject.triangles.size());
    std::vector<std::uint32_t> part_of_set;
    for (std::uint32_t t = 0; t < set_of.size(); ++t) {
      ASSERT_LE(set_of[t], part_of_set.size());
      if (set_of[t] == part_of_set.size()) part_of_set.push_back(parts[t]);
      EXPECT_EQ(part_of_set[set_of[t]], parts[t]);
    }
  }
}

TEST(CompactSets, OfASheetHaveFewVertices) {
  const OverdrawSubject subject = testing::subject_of(sheet(30, 30));
  Random random(1);
  const std::vector<std::uint32_t> set_of = compact_sets(MeshLinks(subject), 50, random);
  // A hexagon of 54 triangles has 37 vertices, 5 x 5 squares have 36.
  EXPECT_LT(static_cast<double>(summed_vertices(subject, set_of)), 0.78 * 1800);
  EXPECT_NEAR(*std::max_element(set_of.begin(), set_of.end()) + 1, 36, 4);
}

TEST(VerticesSaved, IsTheDifferenceOfTheSums) {
  Random random(5);
  for (const OverdrawSubject& subject : subjects()) {
    const MeshLinks links(subject);
    std::vector<std::uint32_t> set_of = compact_sets(links, 6, random);
    const std::uint32_t sets = *std::max_element(set_of.begin(), set_of.end()) + 1;
    for (int trial = 0; trial < 40; ++trial) {
      const auto t = static_cast<std::uint32_t>(random.below(set_of.size()));
      const auto to = static_cast<std::uint32_t>(random.below(sets));
      if (to == set_of[t]) continue;
      const auto before = static_cast<int>(summed_vertices(subject, set_of));
      const int saved = vertices_saved(links, set_of, t, to);
      set_of[t] = to;
      EXPECT_EQ(before - static_cast<int>(summed_vertices(subject, set_of)), saved);
    }
  }
}

// ------------------------------------------------------------------------------------------------ runs

TEST(RunFinder, MissesEveryVertexOfACompactPatchOnce) {
  const OverdrawSubject subject = testing::subject_of(sheet(6, 6));
  const MeshLinks links(subject);
  std::vector<std::uint32_t> all(72);
  std::iota(all.begin(), all.end(), 0U);
  const std::vector<std::uint32_t> run = RunFinder(links, 16).find(all);
  EXPECT_EQ(testing::queue_misses(subject.triangles, run, 16), 49U);
}

TEST(RunFinder, FindsPermutationsWhateverItFoundBefore) {
  Random random(3);
  for (const OverdrawSubject& subject : subjects()) {
    const MeshLinks links(subject);
    for (const std::uint32_t cache_size : {3U, 16U}) {
      RunFinder finder(links, cache_size);
      for (int trial = 0; trial < 5; ++trial) {
        std::vector<std::uint32_t> some;
        for (std::uint32_t t = 0; t < subject.triangles.size(); ++t) {
          if (random.below(3) == 0) some.push_back(t);
        }
        std::vector<std::uint32_t> run = finder.find(some);
        EXPECT_EQ(run, RunFinder(links, cache_size).find(some));
        EXPECT_LE(testing::queue_misses(subject.triangles, run, cache_size), 3 * some.size());
        std::sort(run.begin(), run.end());
        EXPECT_EQ(run, some);
      }
    }
  }
}

// --------------------------------------------------------------------------------------------- patches

struct Scene {
  OverdrawSubject subject;
  std::vector<OverdrawView> views = testing::random_views(subject, 30, 4);
  std::vector<BoundingSphere> spheres = pose_spheres(subject);

  [[nodiscard]] LayerLists lists_of(const Patches& patches) const {
    return list_layers(subject, spheres, patches, views, {64, 1, nullptr});
  }
  [[nodiscard]] std::optional<OrderedPatches> patches(double acmr) const {
    CompactOptions options;
    options.acmr = acmr;
    options.first_ranks = [](const Patches& patches) {
      std::vector<std::uint32_t> ranks(patches.count());
      std::iota(ranks.begin(), ranks.end(), 0U);
      return ranks;
    };
    return compact_patches(subject, lists_of(single_triangles(subject)), options);
  }
};

TEST(ListsOfPatches, AreThoseOfTheirImages) {
  OverdrawSubject subject =
      testing::subject_of({testing::nested_spheres(1), testing::random_soup(60, 0.6, 9)});
  subject.double_sided.assign(subject.triangles.size(), 1);
  // Copies of some triangles: ties.
  subject.triangles.insert(subject.triangles.end(), subject.triangles.end() - 30, subject.triangles.end());
  subject.double_sided.resize(subject.triangles.size(), 1);
  const Scene scene{subject};
  Random random(2);
  const std::vector<std::uint32_t> sequence =
      testing::random_ranks(static_cast<std::uint32_t>(subject.triangles.size()), random);
  Patches patches{sequence, {0}, {}};
  while (patches.offsets.back() < sequence.size()) {
    patches.offsets.push_back(
        std::min(patches.offsets.back() + 1 + static_cast<std::uint32_t>(random.below(20)),
                 static_cast<std::uint32_t>(sequence.size())));
    patches.parts.push_back(0);
  }
  const LayerLists made = lists_of_patches(scene.lists_of(single_triangles(subject)), places_of(patches));
  const LayerLists expected = scene.lists_of(patches);
  EXPECT_EQ(made.pool.layer_count(), expected.pool.layer_count());
  std::vector<std::vector<std::uint32_t>> orders;
  for (int i = 0; i < 5; ++i) orders.push_back(testing::random_ranks(patches.count(), random));
  EXPECT_EQ(overdraw_table(made, orders), overdraw_table(expected, orders));
}

TEST(CompactPatches, HoldTheMissesAndCostWhatTheySay) {
  const Scene scenes[] = {{testing::subject_of(testing::nested_spheres(2))},
                          {testing::sample_subject("torus-knot", 0.1, 1200)},
                          {testing::passing_spheres(2, 1)}};
  for (const Scene& scene : scenes) {
    double last = std::numeric_limits<double>::infinity();
    for (const double acmr : {0.72, 0.85, 1.2}) {
      const std::optional<OrderedPatches> made = scene.patches(acmr);
      ASSERT_TRUE(made);
      const Patches& patches = made->patches;
      EXPECT_TRUE(std::is_sorted(patches.parts.begin(), patches.parts.end()));
      const std::vector<std::uint32_t> parts = part_of_triangles(scene.subject);
      for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
        ASSERT_FALSE(patches.triangles_of(patch).empty());
        for (const std::uint32_t t : patches.triangles_of(patch)) EXPECT_EQ(parts[t], patches.parts[patch]);
      }
      const std::vector<std::uint32_t> sequence =
          expand(patches, sequence_of(made->clustering.ranks.front()));
      std::vector<std::uint32_t> sorted = sequence;
      std::sort(sorted.begin(), sorted.end());
      for (std::uint32_t t = 0; t < sorted.size(); ++t) ASSERT_EQ(sorted[t], t);
      EXPECT_TRUE(testing::parts_stay_together(sequence, parts));
      EXPECT_LE(acmr_of(scene.subject, {sequence}, 16), acmr);
      const std::vector<double> table = overdraw_table(scene.lists_of(patches), made->clustering.ranks);
      EXPECT_NEAR(made->clustering.cost, std::accumulate(table.begin(), table.end(), 0.0), 1e-9);
      EXPECT_LE(made->clustering.cost, last);
      last = made->clustering.cost + 0.02 * static_cast<double>(table.size());
    }
  }
}

TEST(CompactPatches, FewerMissesThanVerticesCannotBeHad) {
  EXPECT_FALSE(Scene{testing::subject_of(testing::nested_spheres(1))}.patches(0.3));
  EXPECT_FALSE(Scene{testing::subject_of(testing::random_soup(30, 0.5, 3))}.patches(2.9));
  EXPECT_TRUE(Scene{testing::subject_of(testing::random_soup(30, 0.5, 3))}.patches(3));
}

}  // namespace
}  // namespace pellucid
