// Tests overdraw orders of posed meshes: every promise of pellucid/overdraw.h.
#include "pellucid/overdraw.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <set>

#include "overdraw_helpers.h"
#include "pellucid/metric.h"

namespace pellucid {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

OverdrawOptions small_options(OverdrawMethod method, std::uint32_t buffers) {
  OverdrawOptions options;
  options.method = method;
  options.buffers = buffers;
  options.view_level = 1;
  options.size = 48;
  return options;
}

constexpr OverdrawMethod kMethods[] = {OverdrawMethod::paper, OverdrawMethod::refined};

void expect_valid(const OverdrawSubject& subject, const OverdrawOptions& options,
                  const OverdrawOrders& made) {
  const std::vector<std::uint32_t> parts = part_of_triangles(subject);
  ASSERT_EQ(made.sequence.size(), subject.triangles.size());
  EXPECT_TRUE(testing::is_permutation_of_all(made.sequence));
  const std::size_t patches = made.patch_parts.size();
  EXPECT_EQ(made.run.patches, patches);
  ASSERT_EQ(made.patch_offsets.size(), patches + 1);
  EXPECT_EQ(made.patch_offsets.front(), 0U);
  EXPECT_EQ(made.patch_offsets.back(), made.sequence.size());
  for (std::size_t patch = 0; patch < patches; ++patch) {
    ASSERT_LT(made.patch_offsets[patch], made.patch_offsets[patch + 1]);
    for (std::uint32_t i = made.patch_offsets[patch]; i < made.patch_offsets[patch + 1]; ++i)
      EXPECT_EQ(parts[made.sequence[i]], made.patch_parts[patch]);
  }
  // Parts in the order of the mesh.
  EXPECT_TRUE(std::is_sorted(made.patch_parts.begin(), made.patch_parts.end()));

  ASSERT_FALSE(made.orders.empty());
  EXPECT_LE(made.orders.size(), options.buffers);
  std::set<std::uint32_t> used;
  for (std::uint32_t order = 0; order < made.orders.size(); ++order) {
    EXPECT_EQ(made.orders[order].size(), patches);
    EXPECT_TRUE(testing::is_permutation_of_all(made.orders[order]));
    EXPECT_TRUE(testing::parts_stay_together(made.orders[order], made.patch_parts));
    const std::vector<std::uint32_t> triangles = triangle_order(made, order);
    EXPECT_EQ(triangles.size(), subject.triangles.size());
    EXPECT_TRUE(testing::is_permutation_of_all(triangles));
    EXPECT_TRUE(testing::parts_stay_together(triangles, parts));
  }

  const std::uint32_t cells = 10 * (1U << (2 * options.view_level)) + 2;
  ASSERT_EQ(made.spheres.size(), subject.frames.size());
  EXPECT_EQ(made.cell_orders.size(), std::size_t{cells} * subject.frames.size());
  for (const std::uint32_t order : made.cell_orders) {
    ASSERT_LT(order, made.orders.size());
    used.insert(order);
  }
  if (options.most_training_views >= made.run.views) {
    EXPECT_EQ(used.size(), made.orders.size());
  }
  EXPECT_EQ(made.run.views, std::uint64_t{cells} * subject.frames.size());
  EXPECT_GE(made.run.training_views, 1U);
  EXPECT_LE(made.run.training_views, made.run.views);
  EXPECT_GE(made.run.training_overdraw, 1);
  std::vector<std::vector<std::uint32_t>> sequences;
  for (std::uint32_t order = 0; order < made.orders.size(); ++order)
    sequences.push_back(triangle_order(made, order));
  EXPECT_NEAR(made.run.acmr, acmr_of(subject, sequences, options.cache_size), 1e-9);
}

// Excess overdraw of every view (frame by frame, cell by cell, at one distance) under every order.
std::vector<std::vector<double>> recount(const OverdrawSubject& subject, const OverdrawOptions& options,
                                         const OverdrawOrders& made) {
  const ViewPartition partition = make_partition({PartitionKind::viewpoints, options.view_level, 0});
  std::vector<std::vector<std::uint32_t>> ranks;
  for (std::uint32_t order = 0; order < made.orders.size(); ++order)
    ranks.push_back(triangle_ranks(triangle_order(made, order)));
  PoseRaster raster(subject, made.spheres, options.size);
  std::vector<std::vector<double>> table;
  for (std::uint32_t frame = 0; frame < subject.frames.size(); ++frame) {
    for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
      std::vector<testing::Drawn> drawn(ranks.size());
      raster.draw({frame, cell, {cell_direction(partition, cell), options.min_distance}},
                  [&](std::uint64_t /*pixel*/, std::span<const Fragment> fragments) {
                    for (std::size_t order = 0; order < ranks.size(); ++order) {
                      ++drawn[order].covered;
                      drawn[order].shaded += testing::draw_fragments(fragments, ranks[order]);
                    }
                  });
      std::vector<double>& row = table.emplace_back();
      for (const testing::Drawn& d : drawn) row.push_back(d.excess());
    }
  }
  return table;
}

OverdrawSubject double_sided_soup() {
  OverdrawSubject soup = testing::subject_of(testing::random_soup(120, 0.4, 3));
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.double_sided.push_back(t % 2 == 0 ? 1 : 0);
  return soup;
}

TEST(OrderOverdraw, EveryTrainingViewHasTheCheapestOfTheOrders) {
  const OverdrawSubject subjects[] = {testing::passing_spheres(2, 3), double_sided_soup(),
                                      testing::twisted(testing::sample_subject("torus-knot", 0.05, 600), 2)};
  for (const OverdrawSubject& subject : subjects) {
    for (const OverdrawMethod method : kMethods) {
      for (const std::uint32_t buffers : {1U, 3U}) {
        for (const std::uint32_t most_training : {6000U, 30U}) {
          OverdrawOptions options = small_options(method, buffers);
          options.min_distance = options.max_distance = 2;
          options.most_training_views = most_training;
          const OverdrawOrders made = order_overdraw(subject, options);
          expect_valid(subject, options, made);
          const std::vector<std::vector<double>> table = recount(subject, options, made);
          ASSERT_EQ(table.size(), made.cell_orders.size());
          double sum = 0;
          std::vector<double> sums(made.orders.size(), 0.0);
          for (std::size_t view = 0; view < table.size(); ++view) {
            const double own = table[view][made.cell_orders[view]];
            if (most_training == 6000U) {
              EXPECT_NEAR(own, *std::min_element(table[view].begin(), table[view].end()), 1e-12) << view;
            }
            sum += own;
            for (std::size_t order = 0; order < sums.size(); ++order) sums[order] += table[view][order];
          }
          // Views between others may have the order of these.
          EXPECT_LE(sum, *std::min_element(sums.begin(), sums.end()) + 1e-9);
          if (most_training == 6000U) {
            EXPECT_EQ(made.run.training_views, made.run.views);
            EXPECT_NEAR(made.run.training_overdraw, 1 + sum / static_cast<double>(table.size()), 1e-9);
          } else {
            EXPECT_LE(made.run.training_views, 40U);
          }
        }
      }
    }
  }
}

TEST(OrderOverdraw, MoreOrdersShadeLess) {
  const OverdrawSubject subject = testing::passing_spheres(2, 3);
  for (const OverdrawMethod method : kMethods) {
    const OverdrawOrders one = order_overdraw(subject, small_options(method, 1));
    const OverdrawOrders five = order_overdraw(subject, small_options(method, 5));
    EXPECT_LT(five.run.training_overdraw - 1, 0.8 * (one.run.training_overdraw - 1));
  }
}

TEST(OrderOverdraw, ASingleConvexMeshHasNoOverdraw) {
  const OverdrawSubject subject = testing::subject_of(testing::icosphere_mesh(2));
  for (const OverdrawMethod method : kMethods) {
    const OverdrawOrders made = order_overdraw(subject, small_options(method, 3));
    expect_valid(subject, small_options(method, 3), made);
    EXPECT_EQ(made.run.training_overdraw, 1);
  }
}

TEST(OrderOverdraw, DependsOnTheSeedAlone) {
  const OverdrawSubject still = testing::sample_subject("torus-knot", 0.05, 600);
  const OverdrawSubject moving = testing::twisted(still, 2);
  const std::tuple<const OverdrawSubject&, OverdrawMethod, std::uint32_t> cases[] = {
      {moving, OverdrawMethod::paper, 3},
      {moving, OverdrawMethod::refined, 3},
      {still, OverdrawMethod::refined, 1}};
  for (const auto& [subject, method, buffers] : cases) {
    OverdrawOptions options = small_options(method, buffers);
    options.most_training_views = 50;
    const auto run = [&, &subject = subject](unsigned threads) {
      const ThreadLimit limit(threads);
      return order_overdraw(subject, options);
    };
    const OverdrawOrders first = run(1);
    for (const OverdrawOrders& other : {run(2), run(1)}) {
      EXPECT_EQ(other.sequence, first.sequence);
      EXPECT_EQ(other.patch_offsets, first.patch_offsets);
      EXPECT_EQ(other.orders, first.orders);
      EXPECT_EQ(other.cell_orders, first.cell_orders);
      EXPECT_EQ(other.run.training_overdraw, first.run.training_overdraw);
    }
    options.seed = 2;
    expect_valid(subject, options, run(2));
  }
}

TEST(OrderOverdraw, RefinedShadesNoMoreThanThePaperInViewsHeldOut) {
  for (const SampleInfo& sample : sample_list()) {
    // Sheets in a plane: cells that see them edge-on, and nothing, do not tell which side is in front.
    if (sample.name == "coplanar-stack") continue;
    const OverdrawSubject subject = testing::sample_subject(sample.name, 0.1, 1200);
    std::vector<OverdrawOrders> made;
    std::vector<std::vector<std::vector<std::uint32_t>>> ranks;
    for (const OverdrawMethod method : kMethods) {
      OverdrawOptions options = small_options(method, 3);
      options.size = 96;
      made.push_back(order_overdraw(subject, options));
      expect_valid(subject, options, made.back());
      ranks.emplace_back();
      for (std::uint32_t order = 0; order < made.back().orders.size(); ++order)
        ranks.back().push_back(triangle_ranks(triangle_order(made.back(), order)));
    }
    const ViewPartition partition = make_partition({PartitionKind::viewpoints, 1, 0});
    std::vector<PosedDrawingMethod> methods;
    for (std::size_t c = 0; c < made.size(); ++c) {
      methods.push_back({"", [&, c](std::uint32_t frame, const Viewpoint& viewpoint) {
                           const std::uint32_t cell = find_cell(partition, viewpoint.direction);
                           const std::size_t view = std::size_t{frame} * partition.cell_count() + cell;
                           return std::span<const std::uint32_t>(ranks[c][made[c].cell_orders[view]]);
                         }});
    }
    PosedOverdrawOptions measurement;
    measurement.viewpoints = 60;
    measurement.size = 96;
    const std::vector<OverdrawQuality> quality = measure_posed_overdraw(subject, methods, measurement);
    EXPECT_LE(quality[1].mean, quality[0].mean) << sample.name;
    EXPECT_GE(quality[1].mean, 1) << sample.name;
    // With no more misses.
    EXPECT_LE(made[1].run.acmr, 1.02 * made[0].run.acmr) << sample.name;
  }
}

TEST(OrderOverdraw, TheAcmrAskedForIsHeld) {
  const OverdrawSubject subject = testing::subject_of(testing::nested_spheres(3));
  double last = std::numeric_limits<double>::infinity();
  for (const double acmr : {0.75, 0.9, 1.4}) {
    OverdrawOptions options = small_options(OverdrawMethod::refined, 3);
    options.acmr = acmr;
    const OverdrawOrders made = order_overdraw(subject, options);
    EXPECT_LE(made.run.acmr, 1.02 * acmr);
    EXPECT_LE(made.run.training_overdraw, last);
    last = made.run.training_overdraw + 0.005;
  }
}

TEST(OrderOverdraw, OneOrderForOnePoseHoldsItExactly) {
  const OverdrawSubject subject = testing::subject_of(testing::nested_spheres(2));
  OverdrawOptions options = small_options(OverdrawMethod::refined, 1);
  options.acmr = 0.7;
  const OverdrawOrders made = order_overdraw(subject, options);
  expect_valid(subject, options, made);
  EXPECT_LE(made.run.acmr, 0.7);
  EXPECT_GT(made.run.acmr, 0.68);
}

TEST(OrderOverdraw, LambdaThreeOrdersSingleTriangles) {
  const OverdrawSubject subject = testing::subject_of(testing::nested_spheres(1));
  for (const OverdrawMethod method : kMethods) {
    OverdrawOptions options = small_options(method, 3);
    options.lambda = 3;
    const OverdrawOrders made = order_overdraw(subject, options);
    expect_valid(subject, options, made);
    EXPECT_EQ(made.patch_parts.size(), subject.triangles.size());
  }
}

TEST(OrderOverdraw, MorePartsThanOrdersCanMix) {
  // Many small parts whose patches would mix in the best order: draw calls stay whole.
  std::vector<Mesh> parts;
  for (std::uint64_t seed = 1; seed <= 7; ++seed) parts.push_back(testing::random_soup(25, 0.5, seed));
  const OverdrawSubject subject = testing::subject_of(parts);
  for (const OverdrawMethod method : kMethods) {
    const OverdrawOptions options = small_options(method, 4);
    expect_valid(subject, options, order_overdraw(subject, options));
  }
}

// -------------------------------------------------------------------------------------- hostile subjects

void expect_valid_by_both(const OverdrawSubject& subject) {
  for (const OverdrawMethod method : kMethods) {
    const OverdrawOptions options = small_options(method, 3);
    expect_valid(subject, options, order_overdraw(subject, options));
  }
}

TEST(OrderOverdraw, SurvivesPositionsThatAreNotFinite) {
  OverdrawSubject subject = testing::passing_spheres(1, 2);
  subject.frames[0][3] = {kNan, 0, 0};
  subject.frames[1][40] = {0, std::numeric_limits<float>::infinity(), 0};
  expect_valid_by_both(subject);
  for (Vec3f& p : subject.frames[1]) p = {kNan, kNan, kNan};
  expect_valid_by_both(subject);
  for (Vec3f& p : subject.frames[0]) p = {kNan, 1, kNan};
  expect_valid_by_both(subject);
}

TEST(OrderOverdraw, SurvivesTrianglesThatDrawNothing) {
  OverdrawSubject subject = testing::passing_spheres(1, 2);
  for (std::size_t t = 0; t < subject.triangles.size(); t += 3)
    subject.triangles[t] = {subject.triangles[t][0], subject.triangles[t][0], subject.triangles[t][1]};
  expect_valid_by_both(subject);
  // All in one point, and a mesh of one triangle.
  for (auto& positions : subject.frames) std::fill(positions.begin(), positions.end(), Vec3f{1, 2, 3});
  expect_valid_by_both(subject);
  expect_valid_by_both(testing::subject_of(testing::one_triangle()));
}

TEST(OrderOverdraw, SurvivesEmptyParts) {
  OverdrawSubject subject = testing::passing_spheres(1, 2);
  const auto count = static_cast<std::uint32_t>(subject.triangles.size());
  subject.parts = {0, 0, count / 2, count / 2, count / 2, count};
  expect_valid_by_both(subject);
}

TEST(OrderOverdraw, NothingToSeeCostsNothing) {
  // No triangle has an area.
  OverdrawSubject subject;
  subject.frames = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  subject.triangles = {{0, 1, 1}, {2, 2, 0}};
  for (const OverdrawMethod method : kMethods) {
    const OverdrawOrders made = order_overdraw(subject, small_options(method, 3));
    expect_valid(subject, small_options(method, 3), made);
    EXPECT_EQ(made.run.training_overdraw, 1);
    EXPECT_EQ(made.run.lists, 0U);
    const std::vector<std::uint32_t> ranks = triangle_ranks(triangle_order(made, 0));
    const std::vector<PosedDrawingMethod> one{
        {"one", [&](std::uint32_t, const Viewpoint&) { return std::span(ranks); }}};
    PosedOverdrawOptions measurement;
    measurement.viewpoints = 3;
    measurement.size = 16;
    const OverdrawQuality quality = measure_posed_overdraw(subject, one, measurement).front();
    EXPECT_EQ(quality.mean, 0);
    EXPECT_EQ(quality.by_frame, std::vector<double>{0});
  }
}

// ----------------------------------------------------------------------------------------------- limits

TEST(OrderOverdraw, TightLimitsStillGiveOrders) {
  const OverdrawSubject subject = testing::passing_spheres(1, 4);
  for (const OverdrawMethod method : kMethods) {
    const auto with = [&](const auto& change) {
      OverdrawOptions options = small_options(method, 3);
      change(options);
      expect_valid(subject, options, order_overdraw(subject, options));
    };
    for (const std::uint64_t most : {0U, 1U, 100U}) with([&](auto& o) { o.most_layers = most; });
    for (const std::uint64_t most : {1U, 42U, 43U, 100U}) {
      with([&](auto& o) { o.most_views = most; });
      with([&](auto& o) {
        o.most_views = most;
        o.most_training_views = 5;
      });
    }
    for (const std::uint32_t most : {0U, 1U, 2U, 7U}) with([&](auto& o) { o.most_training_views = most; });
    with([](auto& o) { o.view_level = 0; });
    with([](auto& o) { o.buffers = 256; });
    with([](auto& o) { o.cache_size = 3; });
    with([](auto& o) { o.size = 16; });
    with([](auto& o) { o.acmr = 0; });
    with([](auto& o) { o.lambda = 1e-9; });
  }
}

TEST(OrderOverdraw, FramesWithoutOwnOrdersHaveThoseOfTheNearest) {
  const OverdrawSubject subject = testing::passing_spheres(1, 6);
  OverdrawOptions options = small_options(OverdrawMethod::refined, 3);
  options.most_views = 42 * 3;  // every other frame
  options.most_training_views = 1;
  const OverdrawOrders made = order_overdraw(subject, options);
  // The only training view is the first.
  for (std::uint32_t frame = 0; frame < 6; ++frame) {
    for (std::uint32_t cell = 0; cell < 42; ++cell) {
      const std::uint32_t own = (frame + 1) / 2 * 2 < 6 ? (frame + 1) / 2 * 2 : 4;
      EXPECT_EQ(made.cell_orders[std::size_t{frame} * 42 + cell],
                made.cell_orders[std::size_t{own} * 42 + cell]);
    }
  }
}

TEST(OrderOverdraw, RefusesWhatMakesNoSense) {
  const OverdrawSubject subject = testing::passing_spheres(0, 1);
  const auto kind_of = [](const OverdrawSubject& of, const OverdrawOptions& options) {
    try {
      order_overdraw(of, options);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::internal;
  };
  OverdrawSubject empty = subject;
  empty.triangles.clear();
  EXPECT_EQ(kind_of(empty, {}), ErrorKind::nothing_to_do);
  empty = subject;
  empty.frames.clear();
  EXPECT_EQ(kind_of(empty, {}), ErrorKind::nothing_to_do);
  EXPECT_EQ(kind_of({}, {}), ErrorKind::nothing_to_do);
  const auto expect_refused = [&](const auto& change) {
    OverdrawOptions options = small_options(OverdrawMethod::paper, 2);
    change(options);
    EXPECT_EQ(kind_of(subject, options), ErrorKind::bad_argument);
  };
  expect_refused([](auto& o) { o.buffers = 0; });
  expect_refused([](auto& o) { o.buffers = 257; });
  expect_refused([](auto& o) { o.cache_size = 2; });
  expect_refused([](auto& o) { o.view_level = 6; });
  expect_refused([](auto& o) { o.lambda = 0; });
  expect_refused([](auto& o) { o.lambda = std::numeric_limits<double>::quiet_NaN(); });
  expect_refused([](auto& o) { o.min_distance = 1; });
  expect_refused([](auto& o) { o.min_distance = std::numeric_limits<double>::quiet_NaN(); });
  expect_refused([](auto& o) { o.max_distance = 1.2; });
  expect_refused([](auto& o) { o.size = 15; });
  expect_refused([](auto& o) { o.size = 5000; });
  expect_refused([](auto& o) { o.most_views = 0; });
}

class StopAfter : public Progress {
 public:
  explicit StopAfter(int questions) : left_(questions) {}
  void begin(std::string_view /*name*/, std::uint64_t /*total*/) override {}
  void advance(std::uint64_t /*amount*/) override {}
  [[nodiscard]] bool stop_requested() const override { return --left_ < 0; }
  [[nodiscard]] int left() const { return left_; }

 private:
  mutable std::atomic<int> left_;
};

TEST(OrderOverdraw, EndsSoonWhenAskedTo) {
  const OverdrawSubject subject = testing::passing_spheres(1, 2);
  for (const OverdrawMethod method : kMethods) {
    OverdrawOptions options = small_options(method, 2);
    options.most_training_views = 40;
    constexpr int kMany = 1'000'000;
    StopAfter never(kMany);
    options.progress = &never;
    order_overdraw(subject, options);
    const int questions = kMany - never.left();
    EXPECT_GE(questions, 84);
    for (int i = 0; i < 8; ++i) {
      StopAfter stop(questions * i / 8);
      options.progress = &stop;
      try {
        order_overdraw(subject, options);
        ADD_FAILURE() << "went on after " << i;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::interrupted);
      }
    }
  }
}

// ----------------------------------------------------------------------------------------- static order

TEST(StaticOverdrawOrder, OuterPatchesFirst) {
  Mesh mesh = testing::icosphere_mesh(2, 0.5);
  testing::append(mesh, testing::icosphere_mesh(2));
  const OverdrawSubject subject = testing::subject_of(mesh);
  const std::vector<std::uint32_t> cached = cache_order(subject, 16);
  const std::vector<std::uint32_t> order = static_overdraw_order(subject, 0, cached, 0.9, 16);
  EXPECT_TRUE(testing::is_permutation_of_all(order));
  ASSERT_EQ(order.size(), 640U);
  for (std::size_t i = 0; i < 640; ++i) EXPECT_EQ(order[i] >= 320, i < 320) << i;
  // No side has wasted fragments.
  for (const OverdrawView& view : testing::random_views(subject, 5, 3))
    EXPECT_LT(testing::draw_view(subject, view, 64, triangle_ranks(order)).excess(), 0.01);
}

TEST(StaticOverdrawOrder, KeepsPartsAndSurvivesAnything) {
  OverdrawSubject subject = testing::passing_spheres(2, 2);
  subject.parts = {0, 100, 100, 320};
  for (std::size_t t = 0; t < subject.triangles.size(); t += 5)
    subject.triangles[t][1] = subject.triangles[t][0];
  subject.frames[1][7] = {kNan, kNan, kNan};
  const std::vector<std::uint32_t> parts = part_of_triangles(subject);
  for (const auto& positions : {Vec3f{0, 0, 0}, Vec3f{kNan, 0, 0}}) {
    subject.frames.emplace_back(subject.frames.front().size(), positions);
  }
  const std::vector<std::uint32_t> cached = cache_order(subject, 16);
  for (std::uint32_t frame = 0; frame < subject.frames.size(); ++frame) {
    const std::vector<std::uint32_t> order = static_overdraw_order(subject, frame, cached, 0.85, 16);
    EXPECT_TRUE(testing::is_permutation_of_all(order));
    ASSERT_EQ(order.size(), subject.triangles.size());
    for (std::size_t i = 1; i < order.size(); ++i) EXPECT_LE(parts[order[i - 1]], parts[order[i]]);
  }
}

}  // namespace
}  // namespace pellucid
