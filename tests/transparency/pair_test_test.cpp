// Tests the narrow phase: SIMD against the scalar version, bit by bit, and the precise test on pairs with
// known results.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstring>

#include "order_helpers.h"
#include "transparency/graph/screen_pairs.h"

namespace pellucid {
namespace {

using testing::random_soup;

ScreenTriangles project(const Mesh& mesh, const Viewpoint& viewpoint) {
  ScreenTriangles screen;
  project_triangles(unit_positions(mesh, bounding_sphere(mesh)), mesh.triangles, viewpoint, false, screen);
  return screen;
}

std::vector<CandidatePair> all_pairs(const ScreenTriangles& screen) {
  std::vector<CandidatePair> pairs;
  for (std::uint32_t a = 0; a < screen.triangles.size(); ++a) {
    for (std::uint32_t b = a + 1; b < screen.triangles.size(); ++b) pairs.push_back({a, b});
  }
  return pairs;
}

struct Answer {
  std::vector<PairEdge> edges;
  std::vector<CandidatePair> doubtful;
};

// PairEdge has no padding: its bytes are its value.
bool same_bytes(const Answer& a, const Answer& b) {
  return a.edges.size() == b.edges.size() && a.doubtful == b.doubtful &&
         (a.edges.empty() ||
          std::memcmp(a.edges.data(), b.edges.data(), a.edges.size() * sizeof(PairEdge)) == 0);
}

// Forget a choice of instruction sets when the test is over.
class TargetsForTest {
 public:
  TargetsForTest() = default;
  TargetsForTest(const TargetsForTest&) = delete;
  TargetsForTest& operator=(const TargetsForTest&) = delete;
  ~TargetsForTest() { use(0); }
  static void use(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST(PairTest, EveryInstructionSetMatchesTheScalarVersionBitByBit) {
  std::vector<Mesh> meshes;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) meshes.push_back(random_soup(40, 0.2 * double(seed), seed));
  meshes.push_back(testing::icosphere_mesh(1));
  meshes.push_back(testing::three_sticks());
  meshes.push_back(testing::sample_mesh("coplanar-stack", 0.02, 100));
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  const TargetsForTest restore;
  std::size_t edges = 0;
  std::size_t doubtful = 0;
  Random random(3);
  for (const Mesh& mesh : meshes) {
    for (const double distance : {1.5, 4.0, kInfiniteDistance}) {
      const ScreenTriangles screen = project(mesh, {random.direction(), distance});
      const std::vector<CandidatePair> pairs = all_pairs(screen);
      for (const float tolerance : {0.0F, 0.01F}) {
        Answer scalar;
        test_pairs_scalar(screen, pairs, tolerance, scalar.edges, scalar.doubtful);
        edges += scalar.edges.size();
        doubtful += scalar.doubtful.size();
        for (const std::int64_t target : targets) {
          TargetsForTest::use(target);
          Answer vector;
          test_pairs(screen, pairs, tolerance, vector.edges, vector.doubtful);
          EXPECT_TRUE(same_bytes(scalar, vector)) << hwy::TargetName(target);
        }
      }
    }
  }
  EXPECT_GT(edges, 1000U);
  EXPECT_GT(doubtful, 100U);
}

TEST(PairTest, AnyCountOfPairsIsTestedOnce) {
  const ScreenTriangles screen = project(random_soup(20, 0.8, 5), {{0, 0, 1}, 3});
  const std::vector<CandidatePair> pairs = all_pairs(screen);
  for (std::size_t count = 0; count <= 40; ++count) {
    Answer scalar;
    Answer vector;
    test_pairs_scalar(screen, {pairs.data(), count}, 0, scalar.edges, scalar.doubtful);
    test_pairs(screen, {pairs.data(), count}, 0, vector.edges, vector.doubtful);
    EXPECT_TRUE(same_bytes(scalar, vector)) << count << " pairs";
  }
}

// Squares of half width 1 and 0.5 in z = 0 and z = 1, as two triangles each; the camera looks along -z.
Mesh squares(float height) {
  return {{{-1, -1, 0},
           {1, -1, 0},
           {1, 1, 0},
           {-1, 1, 0},
           {-0.5F, -0.5F, height},
           {0.5F, -0.5F, height},
           {0.5F, 0.5F, height}},
          {},
          {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}};
}

TEST(PairTest, PreciseJudgeKnowsWhichIsNearer) {
  const Mesh mesh = squares(1);
  const ScreenTriangles screen = project(mesh, {{0, 0, 1}, kInfiniteDistance});
  std::vector<PairEdge> edges;
  EXPECT_FALSE(test_pair_precisely(screen, mesh.triangles, {0, 2}, edges));
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].front, 2U);
  EXPECT_EQ(edges[0].back, 0U);
  // Half of the unit square, in square bounding radii: the sphere's radius is that of the box's corner.
  const double radius = bounding_sphere(mesh).radius;
  EXPECT_NEAR(static_cast<double>(edges[0].area), 0.5 / (radius * radius), 1e-6);
}

TEST(PairTest, CoincidentFacesMakeNoEdge) {
  const Mesh mesh = squares(0);
  const ScreenTriangles screen = project(mesh, {{0, 0, 1}, 2});
  Answer fast;
  test_pairs(screen, all_pairs(screen), 0, fast.edges, fast.doubtful);
  EXPECT_TRUE(fast.edges.empty());
  ASSERT_FALSE(fast.doubtful.empty());
  std::vector<PairEdge> edges;
  for (const CandidatePair& pair : fast.doubtful) {
    EXPECT_FALSE(test_pair_precisely(screen, mesh.triangles, pair, edges));
  }
  EXPECT_TRUE(edges.empty());
}

TEST(PairTest, IntersectingFacesHideEachOtherInPart) {
  // The second triangle rises through the first along x = 0.
  const Mesh mesh{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -1, -0.5F}, {1, -1, 0.5F}, {0, 1, 0}},
                  {},
                  {{0, 1, 2}, {3, 4, 5}}};
  const ScreenTriangles screen = project(mesh, {{0, 0, 1}, kInfiniteDistance});
  std::vector<PairEdge> edges;
  EXPECT_TRUE(test_pair_precisely(screen, mesh.triangles, {0, 1}, edges));
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].front, edges[1].back);
  EXPECT_EQ(edges[0].back, edges[1].front);
  EXPECT_NEAR(static_cast<double>(edges[0].area), static_cast<double>(edges[1].area), 1e-6);
}

}  // namespace
}  // namespace pellucid
