// Tests lists of layers: what drop_hidden() leaves out, the pool, and lists against fragments drawn one by
// one.
#include <gtest/gtest.h>

#include <map>

#include "overdraw/overdraw_costs.h"
#include "overdraw_helpers.h"

namespace pellucid {
namespace {

// ------------------------------------------------------------------------------------------ drop_hidden

struct DrawnFragment {
  std::uint32_t patch, place, depth;
};

// Patches by rank, the fragments of a patch by place, each against the depth buffer.
std::uint32_t simulate(std::vector<DrawnFragment> fragments, const std::vector<std::uint32_t>& ranks) {
  std::sort(fragments.begin(), fragments.end(), [&](const DrawnFragment& a, const DrawnFragment& b) {
    return a.patch != b.patch ? ranks[a.patch] < ranks[b.patch] : a.place < b.place;
  });
  std::uint32_t nearest = 0xFFFFFFFFU;
  std::uint32_t shaded = 0;
  for (const DrawnFragment& fragment : fragments) {
    if (fragment.depth >= nearest) continue;
    nearest = fragment.depth;
    ++shaded;
  }
  return shaded;
}

TEST(DropHidden, KeepsWhatEveryOrderShades) {
  Random random(1);
  std::size_t dropped = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const auto patches = static_cast<std::uint32_t>(1 + random.below(4));
    const auto count = static_cast<std::uint32_t>(1 + random.below(8));
    const std::uint64_t ties = random.below(5);  // of four: how many are tied
    std::vector<std::uint32_t> places = testing::random_ranks(count, random);
    std::vector<DrawnFragment> fragments;
    std::vector<Layer> layers;
    std::uint32_t depth = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto patch = static_cast<std::uint32_t>(random.below(patches));
      const bool tied = i > 0 && random.below(4) < ties;
      if (!tied) ++depth;
      fragments.push_back({patch, places[i], depth});
      layers.push_back(patch | (tied ? kTieBit : 0));
    }
    drop_hidden(layers, places);
    ASSERT_EQ(layers.size(), places.size());
    ASSERT_FALSE(layers.empty());
    EXPECT_FALSE(is_tied(layers.front()));
    dropped += count - layers.size();
    std::vector<std::uint32_t> sequence(patches);
    std::iota(sequence.begin(), sequence.end(), 0U);
    do {
      const std::vector<std::uint32_t> ranks = triangle_ranks(sequence);
      ASSERT_EQ(shaded_layers(layers, ranks), simulate(fragments, ranks)) << trial;
    } while (std::next_permutation(sequence.begin(), sequence.end()));

    // Nothing is left to drop: no patch twice at one depth, and the nearer of two is drawn later.
    for (std::size_t i = 0; i < layers.size(); ++i) {
      bool same_depth = true;
      for (std::size_t j = i + 1; j < layers.size(); ++j) {
        same_depth = same_depth && is_tied(layers[j]);
        if (patch_of_layer(layers[i]) != patch_of_layer(layers[j])) continue;
        EXPECT_FALSE(same_depth);
        EXPECT_GT(places[i], places[j]);
      }
    }
    std::vector<Layer> again = layers;
    std::vector<std::uint32_t> places_again = places;
    drop_hidden(again, places_again);
    EXPECT_EQ(again, layers);
    EXPECT_EQ(places_again, places);
  }
  EXPECT_GT(dropped, 4000U);
}

TEST(DropHidden, LiteralCases) {
  using Layers = std::vector<Layer>;
  using Places = std::vector<std::uint32_t>;
  const auto dropped = [](Layers layers, Places places) {
    drop_hidden(layers, places);
    return layers;
  };
  EXPECT_EQ(dropped({}, {}), Layers{});
  // Nearer and earlier hides; nearer and later does not.
  EXPECT_EQ(dropped({3, 3}, {0, 1}), Layers{3});
  EXPECT_EQ(dropped({3, 3}, {1, 0}), (Layers{3, 3}));
  // At one depth a patch counts once, and what follows it there is still tied.
  EXPECT_EQ(dropped({3, 3 | kTieBit, 5 | kTieBit}, {1, 0, 0}), (Layers{3, 5 | kTieBit}));
  // The first of a depth is hidden: the next one opens it.
  EXPECT_EQ(dropped({3, 3, 5 | kTieBit}, {0, 1, 0}), (Layers{3, 5}));
  // Of two at one depth the earlier place hides what lies behind.
  EXPECT_EQ(dropped({3, 3 | kTieBit, 3}, {2, 0, 1}), Layers{3});
}

// ----------------------------------------------------------------------------------------------- costs

TEST(ShadedLayers, ArePrefixMinima) {
  const std::vector<Layer> list{0, 1, 2 | kTieBit, 3};
  EXPECT_EQ(shaded_layers(list, std::vector<std::uint32_t>{0, 1, 2, 3}), 1U);
  EXPECT_EQ(shaded_layers(list, std::vector<std::uint32_t>{3, 2, 1, 0}), 3U);
  EXPECT_EQ(shaded_layers(list, std::vector<std::uint32_t>{2, 0, 1, 3}), 2U);
  EXPECT_EQ(shaded_layers(list, std::vector<std::uint32_t>{1, 2, 0, 3}), 2U);
}

TEST(OverdrawTable, SumsTheListsOfEveryView) {
  Random random(3);
  const LayerLists lists = testing::random_lists(12, 20, 7, 30, random);
  // More orders than are counted side by side.
  std::vector<std::vector<std::uint32_t>> orders;
  for (int i = 0; i < 19; ++i) orders.push_back(testing::random_ranks(12, random));
  const std::vector<double> table = overdraw_table(lists, orders);
  ASSERT_EQ(table.size(), 7U * 19U);
  for (std::uint32_t view = 0; view < 7; ++view) {
    for (std::size_t order = 0; order < orders.size(); ++order) {
      std::uint64_t excess = 0;
      for (const ListUse& use : lists.uses_of(view))
        excess += std::uint64_t{use.pixels} * (shaded_layers(lists.pool.list(use.list), orders[order]) - 1);
      const double expected = static_cast<double>(excess) / static_cast<double>(lists.covered[view]);
      EXPECT_NEAR(table[view * orders.size() + order], expected, 1e-12);
    }
  }
  // Weighed lists of some views say the same, in their unit.
  const std::vector<std::uint32_t> some{1, 4, 6};
  const std::vector<WeightedList> weighted = weigh_lists(lists, some);
  for (std::size_t order = 0; order < orders.size(); ++order) {
    double expected = 0;
    for (const std::uint32_t view : some) expected += table[view * orders.size() + order];
    const auto excess = static_cast<double>(excess_of(lists.pool, weighted, orders[order]));
    EXPECT_NEAR(excess / static_cast<double>(kOverdrawUnit), expected, 1e-4);
  }
}

TEST(OverdrawTable, ViewsOfNothingCostNothing) {
  LayerLists lists;
  lists.offsets.push_back(0);
  lists.covered.push_back(0);
  EXPECT_EQ(overdraw_table(lists, {{0, 1}, {1, 0}}), (std::vector<double>{0, 0}));
  EXPECT_TRUE(weigh_lists(lists, std::vector<std::uint32_t>{0}).empty());
}

// ------------------------------------------------------------------------------------------------- pool

TEST(ListPool, NumbersDistinctListsAsTheyAreMet) {
  Random random(5);
  ListPool pool;
  for (int round = 0; round < 2; ++round) {
    std::map<std::vector<Layer>, std::uint32_t> known;
    std::uint64_t layers = 0;
    for (int i = 0; i < 30000; ++i) {
      std::vector<Layer> list;
      const std::uint64_t size = random.below(7);
      for (std::uint64_t k = 0; k < size; ++k)
        list.push_back(static_cast<Layer>(random.below(5)) | (random.below(3) == 0 ? kTieBit : 0));
      const auto [entry, is_new] = known.emplace(list, static_cast<std::uint32_t>(known.size()));
      if (is_new) layers += size;
      ASSERT_EQ(pool.number_of(list), entry->second);
      ASSERT_EQ(pool.count(), known.size());
    }
    EXPECT_GT(pool.count(), 10000U);
    EXPECT_EQ(pool.layer_count(), layers);
    for (const auto& [list, number] : known) {
      const std::span<const Layer> kept = pool.list(number);
      ASSERT_EQ(std::vector<Layer>(kept.begin(), kept.end()), list);
    }
    pool.clear();
    EXPECT_EQ(pool.count(), 0U);
    EXPECT_EQ(pool.layer_count(), 0U);
  }
}

// ---------------------------------------------------------------------------------------------- lists

Patches random_patches(const OverdrawSubject& subject, double lambda) {
  return cut_patches(subject, cache_order(subject, 16), lambda, 16);
}

void expect_lists_count_what_is_shaded(const OverdrawSubject& subject, const Patches& patches) {
  constexpr std::uint32_t kSize = 48;
  const std::vector<OverdrawView> views = testing::random_views(subject, 3, 11);
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  const LayerLists lists = list_layers(subject, spheres, patches, views, {kSize, 1, nullptr});
  ASSERT_EQ(lists.view_count(), views.size());
  Random random(17);
  std::vector<std::vector<std::uint32_t>> orders;
  for (int i = 0; i < 3; ++i) orders.push_back(testing::random_ranks(patches.count(), random));
  const std::vector<double> table = overdraw_table(lists, orders);
  for (std::size_t order = 0; order < orders.size(); ++order) {
    std::vector<std::uint32_t> drawn(patches.count());
    for (std::uint32_t patch = 0; patch < patches.count(); ++patch) drawn[orders[order][patch]] = patch;
    const std::vector<std::uint32_t> ranks = triangle_ranks(expand(patches, drawn));
    for (std::size_t v = 0; v < views.size(); ++v) {
      const testing::Drawn expected = testing::draw_view(subject, views[v], kSize, ranks);
      EXPECT_EQ(lists.covered[v], expected.covered);
      EXPECT_NEAR(table[v * orders.size() + order], expected.excess(), 1e-12) << v << " " << order;
      const std::vector<std::uint32_t> shaded =
          shaded_fragments(subject, views[v].frame, views[v].viewpoint, kSize, ranks);
      EXPECT_EQ(std::accumulate(shaded.begin(), shaded.end(), std::uint64_t{0}), expected.shaded);
    }
  }
}

TEST(ListLayers, CountWhatADepthBufferShades) {
  const OverdrawSubject soup = testing::subject_of(testing::random_soup(150, 0.5, 3));
  const OverdrawSubject shells = testing::subject_of(testing::nested_spheres(2));
  OverdrawSubject parts = testing::subject_of(
      {testing::icosphere_mesh(1), testing::random_soup(60, 0.6, 9), testing::icosphere_mesh(1, 0.5)});
  expect_lists_count_what_is_shaded(soup, random_patches(soup, 3));
  expect_lists_count_what_is_shaded(shells, random_patches(shells, 0.9));
  expect_lists_count_what_is_shaded(shells, random_patches(shells, 1.6));
  expect_lists_count_what_is_shaded(parts, random_patches(parts, 1.2));
  for (std::size_t t = 0; t < parts.triangles.size(); ++t) parts.double_sided.push_back(t % 3 != 0 ? 1 : 0);
  expect_lists_count_what_is_shaded(parts, random_patches(parts, 1.2));
  const OverdrawSubject moving = testing::passing_spheres(2, 3);
  expect_lists_count_what_is_shaded(moving, random_patches(moving, 1));
}

TEST(ListLayers, CopiesOfATriangleAreAsNearAsItself) {
  // Every triangle twice, the copies in other patches: ties everywhere.
  Mesh mesh = testing::random_soup(40, 0.7, 21);
  const Mesh copy = mesh;
  testing::append(mesh, copy);
  OverdrawSubject subject = testing::subject_of(mesh);
  expect_lists_count_what_is_shaded(subject, random_patches(subject, 3));
  subject.double_sided.assign(subject.triangles.size(), 1);
  expect_lists_count_what_is_shaded(subject, random_patches(subject, 3));
  // Some copies in one patch with others.
  Patches patches = random_patches(subject, 3);
  std::vector<std::uint8_t> join(patches.count(), 0);
  Random random(2);
  for (std::size_t i = 0; i + 1 < join.size(); ++i) join[i] = random.below(3) != 0 ? 1 : 0;
  expect_lists_count_what_is_shaded(subject, join_patches(patches, join).patches);
}

TEST(ListLayers, AShareOfThePixelsStandsForAll) {
  const OverdrawSubject subject = testing::subject_of(testing::nested_spheres(2));
  const Patches patches = random_patches(subject, 1.2);
  const std::vector<OverdrawView> views = testing::random_views(subject, 6, 5);
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  const LayerLists all = list_layers(subject, spheres, patches, views, {96, 1, nullptr});
  const LayerLists some = list_layers(subject, spheres, patches, views, {96, 0.25, nullptr});
  const LayerLists none = list_layers(subject, spheres, patches, views, {96, 0, nullptr});
  Random random(6);
  const std::vector<std::vector<std::uint32_t>> orders{testing::random_ranks(patches.count(), random)};
  const std::vector<double> expected = overdraw_table(all, orders);
  const std::vector<double> estimated = overdraw_table(some, orders);
  for (std::size_t v = 0; v < views.size(); ++v) {
    EXPECT_NEAR(static_cast<double>(some.covered[v]), 0.25 * static_cast<double>(all.covered[v]),
                0.05 * static_cast<double>(all.covered[v]));
    EXPECT_NEAR(estimated[v], expected[v], 0.15 * (1 + expected[v]));
    EXPECT_EQ(none.covered[v], 0U);
  }
}

TEST(ListLayers, ManyViewsAreListedInTheirSequence) {
  // More than one block of views; alone or with others, a view's pixels say the same.
  const OverdrawSubject subject = testing::subject_of(testing::random_soup(20, 0.8, 4));
  const Patches patches = random_patches(subject, 3);
  const std::vector<OverdrawView> views = testing::random_views(subject, 300, 8);
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  const LayerLists all = list_layers(subject, spheres, patches, views, {16, 1, nullptr});
  ASSERT_EQ(all.view_count(), 300U);
  Random random(6);
  const std::vector<std::vector<std::uint32_t>> orders{testing::random_ranks(patches.count(), random)};
  const std::vector<double> table = overdraw_table(all, orders);
  const std::vector<std::uint32_t> some{299, 3, 257, 255, 256};
  const std::vector<double> table_of_some = overdraw_table(lists_of_views(all, some), orders);
  for (std::size_t i = 0; i < some.size(); ++i) {
    const LayerLists alone =
        list_layers(subject, spheres, patches, std::span(views).subspan(some[i], 1), {16, 1, nullptr});
    EXPECT_EQ(overdraw_table(alone, orders).front(), table[some[i]]);
    EXPECT_EQ(table_of_some[i], table[some[i]]);
  }
}

TEST(JoinedLists, CostWhatListsOfJoinedPatchesCost) {
  OverdrawSubject subject = testing::subject_of(
      {testing::nested_spheres(1), testing::random_soup(60, 0.6, 9), testing::icosphere_mesh(1, 1.2)});
  subject.double_sided.assign(subject.triangles.size(), 1);
  const std::vector<OverdrawView> views = testing::random_views(subject, 4, 19);
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  Patches patches = random_patches(subject, 3);
  LayerLists lists = list_layers(subject, spheres, patches, views, {48, 1, nullptr});
  Random random(23);
  for (int round = 0; round < 4; ++round) {
    std::vector<std::uint8_t> join(patches.count(), 0);
    for (std::uint32_t patch = 0; patch + 1 < patches.count(); ++patch) {
      if (patches.parts[patch] == patches.parts[patch + 1]) join[patch] = random.below(2) == 0 ? 1 : 0;
    }
    const JoinedPatches joined = join_patches(patches, join);
    lists = joined_lists(lists, joined.patch_of);
    patches = joined.patches;
    const LayerLists anew = list_layers(subject, spheres, patches, views, {48, 1, nullptr});
    EXPECT_EQ(lists.covered, anew.covered);
    EXPECT_EQ(lists.pool.layer_count(), anew.pool.layer_count());
    std::vector<std::vector<std::uint32_t>> orders;
    for (int i = 0; i < 5; ++i) orders.push_back(testing::random_ranks(patches.count(), random));
    EXPECT_EQ(overdraw_table(lists, orders), overdraw_table(anew, orders)) << round;
  }
}

// ------------------------------------------------------------------------------------------ measurement

TEST(MeasurePosedOverdraw, IsTheMeanOverImages) {
  const OverdrawSubject subject = testing::passing_spheres(1, 2);
  Random random(3);
  const auto count = static_cast<std::uint32_t>(subject.triangles.size());
  const std::vector<std::vector<std::uint32_t>> ranks{testing::random_ranks(count, random),
                                                      testing::random_ranks(count, random)};
  PosedOverdrawOptions options;
  options.viewpoints = 5;
  options.size = 40;
  const std::vector<PosedDrawingMethod> methods{
      {"first", [&](std::uint32_t, const Viewpoint&) { return std::span(ranks[0]); }},
      {"by frame", [&](std::uint32_t frame, const Viewpoint&) { return std::span(ranks[frame]); }}};
  const std::vector<OverdrawQuality> measured = measure_posed_overdraw(subject, methods, options);
  ASSERT_EQ(measured.size(), 2U);
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(5, options.min_distance, options.max_distance, options.seed);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(measured[c].name, methods[c].name);
    double mean = 0, max = 0;
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
      double of_frame = 0;
      for (const Viewpoint& viewpoint : viewpoints) {
        const double overdraw =
            1 + testing::draw_view(subject, {frame, 0, viewpoint}, 40, ranks[c == 1 ? frame : 0]).excess();
        of_frame += overdraw / 5;
        max = std::max(max, overdraw);
      }
      EXPECT_NEAR(measured[c].by_frame[frame], of_frame, 1e-12);
      mean += of_frame / 2;
    }
    EXPECT_NEAR(measured[c].mean, mean, 1e-12);
    EXPECT_NEAR(measured[c].max, max, 1e-12);
  }
}

TEST(MeasurePosedOverdraw, FewerImagesStillShowEveryFrame) {
  const OverdrawSubject subject = testing::passing_spheres(0, 6);
  const std::vector<std::uint32_t> ranks = triangle_ranks(cache_order(subject, 16));
  PosedOverdrawOptions options;
  options.viewpoints = 10;
  options.size = 32;
  for (const std::uint64_t most : {1U, 12U, 1000U}) {
    options.most_images = most;
    std::atomic<std::uint64_t> images = 0;
    const std::vector<PosedDrawingMethod> one{{"one", [&](std::uint32_t, const Viewpoint&) {
                                                 ++images;
                                                 return std::span(ranks);
                                               }}};
    const OverdrawQuality quality = measure_posed_overdraw(subject, one, options).front();
    EXPECT_EQ(images, most == 1 ? 6U : (most == 12 ? 12U : 60U));
    for (const double of_frame : quality.by_frame) EXPECT_GE(of_frame, 1);
  }
}

}  // namespace
}  // namespace pellucid
