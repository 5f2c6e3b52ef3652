// Tests depth-presorted lists against the raster, from the viewpoints for which they are made and between
// them.
#include <gtest/gtest.h>

#include "baseline/presorted_region.h"
#include "order_helpers.h"
#include "pellucid/baseline.h"
#include "pellucid/raster.h"

namespace pellucid {
namespace {

PresortedOptions quick_options(std::uint32_t regions, const char* partition = "S1,1") {
  PresortedOptions options;
  options.regions = regions;
  options.partition = parse_partition(partition);
  return options;
}

NodeSequence drawn_from(const PresortedLists& lists, const Viewpoint& view) {
  NodeSequence nodes;
  walk_list(lists, select_list(lists, view.direction), eye_of(lists.sphere, view), nodes);
  return nodes;
}

PixelCount wrong_pixels(const Mesh& mesh, const Viewpoint& view, const NodeSequence& nodes) {
  FragmentBuffer fragments;
  rasterize(mesh, look_at_sphere(bounding_sphere(mesh), view, 128, 128), {}, fragments);
  return count_incorrect_pixels(fragments, ranks_of(nodes, mesh.triangles.size()));
}

// The viewpoints whose occlusions the lists were made from.
std::vector<Viewpoint> sampled_viewpoints(const PresortedOptions& options) {
  const std::vector<double> distances = default_distances();
  std::vector<Viewpoint> views;
  for (const Vec3d& sample : make_partition(options.partition).samples) {
    views.push_back({sample, distances[views.size() % distances.size()]});
  }
  return views;
}

std::size_t copies_with_tests(const PresortedLists& lists) {
  std::size_t count = 0;
  for (const PresortedList& list : lists.lists) {
    for (std::size_t i = 0; i < list.nodes.size(); ++i) {
      if (list.test_offsets[i + 1] > list.test_offsets[i]) ++count;
    }
  }
  return count;
}

TEST(PresortedLists, AreRightFromTheViewpointsTheyAreMadeFor) {
  // Layers without crossings, over half of the sphere at once: no single order could do.
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 500);
  const PresortedOptions options = quick_options(2);
  const PresortedLists lists = build_presorted_lists(mesh, options);
  ASSERT_TRUE(lists.complete);
  ASSERT_EQ(lists.lists.size(), 2U);
  EXPECT_GT(copies_with_tests(lists), 10U);
  PixelCount right;
  PixelCount without_tests;
  for (const Viewpoint& view : sampled_viewpoints(options)) {
    const PixelCount count = wrong_pixels(mesh, view, drawn_from(lists, view));
    right.foreground += count.foreground;
    right.incorrect += count.incorrect;
    NodeSequence all;  // the last copy of each node, whatever its tests say
    for (const NodeId node : select_list(lists, view.direction).nodes) all.push_back(node);
    without_tests.incorrect += wrong_pixels(mesh, view, all).incorrect;
  }
  EXPECT_GT(right.foreground, 100000U);
  EXPECT_LT(right.incorrect, right.foreground / 2000);
  EXPECT_GT(without_tests.incorrect, 10 * right.incorrect + 100);
}

TEST(PresortedLists, BetweenThoseViewpointsTheyAreNearlyRight) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 600);
  const PresortedLists lists = build_presorted_lists(mesh, quick_options(4));
  PixelCount sum;
  for (const Viewpoint& view : random_viewpoints(60, 2, 5, 3)) {
    const PixelCount count = wrong_pixels(mesh, view, drawn_from(lists, view));
    sum.foreground += count.foreground;
    sum.incorrect += count.incorrect;
  }
  EXPECT_LT(sum.incorrect, sum.foreground / 200);
}

TEST(PresortedLists, DrawEveryVisibleNodeExactlyOnce) {
  const Mesh mesh = testing::random_soup(80, 0.5, 4);
  const PresortedLists lists = build_presorted_lists(mesh, quick_options(3));
  ASSERT_TRUE(lists.complete);
  EXPECT_GT(copies_with_tests(lists), 20U);
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    const Viewpoint view{random.direction(), k % 4 == 0 ? kInfiniteDistance : random.uniform(1.6, 6)};
    const Eye eye = eye_of(lists.sphere, view);
    const NodeSequence nodes = drawn_from(lists, view);
    std::vector<int> times(2 * mesh.triangles.size(), 0);
    for (const NodeId node : nodes) ++times[node];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3d corner = to_double(mesh.positions[mesh.triangles[t][0]]);
      const bool front = dot(triangle_normal(mesh, t), eye.at - corner * eye.w) > 0;
      EXPECT_EQ(times[node_of(t, !front)], 1) << t;
      EXPECT_LE(times[node_of(t, front)], 1) << t;
    }
  }
}

TEST(PresortedLists, FacesThatCrossAreNotSplitForever) {
  Mesh mesh = testing::one_triangle();
  testing::append(mesh, {{{0.3F, 0.3F, -1}, {0.3F, 0.3F, 1}, {1, 1, 0.2F}}, {}, {{0, 1, 2}}});
  const PresortedLists lists = build_presorted_lists(mesh, quick_options(1));
  ASSERT_TRUE(lists.complete);
  EXPECT_LT(lists.lists[0].nodes.size(), 100U);
}

TEST(PresortedLists, DegenerateMeshes) {
  const Mesh one = testing::one_triangle();
  const PresortedLists lists = build_presorted_lists(one, quick_options(6));
  EXPECT_TRUE(lists.planes.empty());
  EXPECT_EQ(lists.lists.front().nodes.size(), 2U);  // culling leaves the one that faces the camera

  Mesh doubled = one;
  testing::append(doubled, one);
  EXPECT_EQ(build_presorted_lists(doubled, quick_options(6)).violated_edges, 0U);

  const PresortedLists none = build_presorted_lists({}, quick_options(2));
  EXPECT_TRUE(none.complete);
  EXPECT_TRUE(drawn_from(none, {{0, 0, 1}, 3}).empty());

  // More regions than cells.
  const PresortedLists many = build_presorted_lists(one, quick_options(1000, "S0,0"));
  EXPECT_LE(many.lists.size(), 20U);
}

TEST(PresortedLists, SingleSidedListsHoldNoTwins) {
  PresortedOptions options = quick_options(2);
  options.facing = Facing::single;
  for (const PresortedList& list : build_presorted_lists(testing::nested_spheres(1), options).lists) {
    EXPECT_FALSE(list.nodes.empty());
    for (const NodeId node : list.nodes) EXPECT_FALSE(is_flipped(node));
  }
}

TEST(PresortedLists, GiveUpAtTheirLimits) {
  const Mesh mesh = testing::random_soup(80, 0.5, 4);
  PresortedOptions options = quick_options(1);
  options.max_copies = 161;
  EXPECT_FALSE(build_presorted_lists(mesh, options).complete);
  options = quick_options(1);
  options.max_edges = 100;
  EXPECT_FALSE(build_presorted_lists(mesh, options).complete);
  EXPECT_THROW(build_presorted_lists(mesh, quick_options(0)), Error);
  EXPECT_THROW(build_presorted_lists(mesh, quick_options(2, "P1")), Error);
}

TEST(PresortedLists, SameListsForAnyNumberOfThreads) {
  const Mesh mesh = testing::random_soup(60, 0.5, 8);
  const auto build = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    return build_presorted_lists(mesh, quick_options(2));
  };
  const PresortedLists a = build(1);
  const PresortedLists b = build(4);
  ASSERT_EQ(a.lists.size(), b.lists.size());
  for (std::size_t i = 0; i < a.lists.size(); ++i) {
    EXPECT_EQ(a.lists[i].nodes, b.lists[i].nodes);
    EXPECT_EQ(a.lists[i].tests, b.lists[i].tests);
  }
}

TEST(RegionOcclusions, GatherTheViewpointsOfEveryPair) {
  // Two viewpoints, two triangles; the first hides the second from both, once over next to nothing.
  ViewpointEdges near;
  near.offsets = {0, 1, 1};
  near.backs = {node_of(1, true)};
  near.areas = {0.5F};
  near.front_flipped = {0, 1};
  ViewpointEdges far = near;
  const std::vector<const ViewpointEdges*> views{&near, &far};
  const RegionOcclusions both = collect_edges(views, 2, 0.1F);
  EXPECT_EQ(both.backs, (std::vector<NodeId>{node_of(1, true)}));
  EXPECT_EQ(both.views, (std::vector<std::uint16_t>{0, 1}));
  EXPECT_EQ(both.offsets, (std::vector<std::uint64_t>{0, 1, 1, 1, 1}));
  far.areas = {0.01F};
  EXPECT_EQ(collect_edges(views, 2, 0.1F).views, (std::vector<std::uint16_t>{0}));
  far.areas = {0.5F};
  far.front_flipped = {1, 1};  // another node hides it
  EXPECT_EQ(collect_edges(views, 2, 0.1F).backs.size(), 2U);
}

TEST(RegionOcclusions, OfFacesThatCrossTheOneThatHidesMoreIsInFront) {
  ViewpointEdges view;
  view.offsets = {0, 1, 2};
  view.backs = {node_of(1, false), node_of(0, false)};
  view.areas = {0.5F, 0.7F};
  view.front_flipped = {0, 0};
  view.intersecting = 1;
  const std::vector<const ViewpointEdges*> views{&view};
  EXPECT_EQ(collect_edges(views, 2, 0.1F).backs, (std::vector<NodeId>{node_of(0, false)}));
  view.areas = {0.5F, 0.5F};  // a tie: one of them all the same
  EXPECT_EQ(collect_edges(views, 2, 0.1F).backs.size(), 1U);
}

}  // namespace
}  // namespace pellucid
