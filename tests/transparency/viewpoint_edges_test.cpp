// Tests the edges of one viewpoint against an oracle that does not use the projection map. It clips the
// images of all pairs of triangles in double precision and measures depth along rays to the planes in space.
#include "transparency/graph/viewpoint_edges.h"

#include <gtest/gtest.h>

#include "order_helpers.h"
#include "pellucid/raster.h"

namespace pellucid {
namespace {

using testing::EdgeMap;
using testing::random_soup;

struct Point2 {
  double x, y;
};

double doubled_area(const std::vector<Point2>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& p = polygon[i];
    const Point2& q = polygon[(i + 1) % polygon.size()];
    sum += p.x * q.y - q.x * p.y;
  }
  return sum;
}

std::vector<Point2> clip(const std::vector<Point2>& polygon, const Point2& from, const Point2& to) {
  const auto side = [&](const Point2& p) {
    return (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
  };
  std::vector<Point2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& p = polygon[i];
    const Point2& q = polygon[(i + 1) % polygon.size()];
    const double sp = side(p);
    const double sq = side(q);
    if (sp >= 0) kept.push_back(p);
    if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) {
      const double t = sp / (sp - sq);
      kept.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
  }
  return kept;
}

// Everything in bounding radii about the sphere's centre.
class Oracle {
 public:
  Oracle(const Mesh& mesh, const Viewpoint& viewpoint) : mesh_(mesh), viewpoint_(viewpoint) {
    const BoundingSphere sphere = bounding_sphere(mesh);
    for (const Vec3f& p : mesh.positions)
      positions_.push_back((to_double(p) - sphere.center) / sphere.radius);
    const Vec3d d = viewpoint.direction;
    right_ = normalized(cross(std::fabs(d.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, d));
    up_ = cross(d, right_);
  }

  struct Overlap {
    double area = 0;                  // of the image, at the centre's depth
    double a_ahead = 0, b_ahead = 0;  // how far one lies before the other at most, along a ray
    NodeId node_a = 0, node_b = 0;
  };

  [[nodiscard]] Overlap overlap(std::uint32_t a, std::uint32_t b) const {
    Overlap result;
    result.node_a = node_of(a, flipped(a));
    result.node_b = node_of(b, flipped(b));
    std::vector<Point2> polygon = image_of(a);
    const std::vector<Point2> other = image_of(b);
    for (std::size_t i = 0; i < 3 && polygon.size() >= 3; ++i)
      polygon = clip(polygon, other[i], other[(i + 1) % 3]);
    if (polygon.size() < 3) return result;
    result.area = 0.5 * doubled_area(polygon);
    for (const Point2& p : polygon) {
      const double difference = depth(b, p) - depth(a, p);
      result.a_ahead = std::max(result.a_ahead, difference);
      result.b_ahead = std::max(result.b_ahead, -difference);
    }
    return result;
  }

 private:
  [[nodiscard]] bool orthographic() const { return std::isinf(viewpoint_.distance); }
  [[nodiscard]] Vec3d corner(std::uint32_t t, std::size_t k) const {
    return positions_[mesh_.triangles[t][k]];
  }
  [[nodiscard]] Vec3d normal(std::uint32_t t) const {
    return cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
  }
  [[nodiscard]] Vec3d eye() const { return viewpoint_.direction * viewpoint_.distance; }
  [[nodiscard]] bool flipped(std::uint32_t t) const {
    return dot(normal(t), orthographic() ? viewpoint_.direction : eye() - corner(t, 0)) < 0;
  }

  // Counter-clockwise image in the plane through the sphere's centre.
  [[nodiscard]] std::vector<Point2> image_of(std::uint32_t t) const {
    std::vector<Point2> polygon;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3d p = corner(t, k);
      if (!orthographic()) {
        const Vec3d ray = p - eye();
        p = eye() + ray * (viewpoint_.distance / -dot(ray, viewpoint_.direction));
      }
      polygon.push_back({dot(p, right_), dot(p, up_)});
    }
    if (doubled_area(polygon) < 0) std::swap(polygon[1], polygon[2]);
    return polygon;
  }

  // Distance along the ray through an image point to the plane of a triangle.
  [[nodiscard]] double depth(std::uint32_t t, const Point2& p) const {
    const Vec3d on_image = right_ * p.x + up_ * p.y;
    const Vec3d origin = orthographic() ? on_image : eye();
    const Vec3d ray = orthographic() ? -viewpoint_.direction : normalized(on_image - eye());
    return dot(normal(t), corner(t, 0) - origin) / dot(normal(t), ray);
  }

  const Mesh& mesh_;
  Viewpoint viewpoint_;
  std::vector<Vec3d> positions_;
  Vec3d right_, up_;
};

OcclusionScene scene_of(const Mesh& mesh, double tolerance = 0) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  return {mesh, sphere, unit_positions(mesh, sphere), false, tolerance, 512};
}

EdgeMap map_of(const ViewpointEdges& edges) {
  EdgeMap map;
  for (std::uint32_t t = 0; t + 1 < edges.offsets.size(); ++t) {
    for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i) {
      const auto inserted = map.emplace(std::pair{node_of(t, edges.front_flipped[t] != 0), edges.backs[i]},
                                        static_cast<double>(edges.areas[i]));
      EXPECT_TRUE(inserted.second) << "an edge stands twice";
    }
  }
  return map;
}

EdgeMap exact_edges(const Mesh& mesh, const Viewpoint& viewpoint, double tolerance = 0) {
  OcclusionScratch scratch;
  ViewpointEdges edges;
  find_edges_exactly(scene_of(mesh, tolerance), viewpoint, scratch, edges);
  return map_of(edges);
}

// Overlaps too small, or faces too close, for single precision input to decide.
constexpr double kSmallArea = 1e-5;
constexpr double kSmallDepth = 1e-4;

std::size_t compare_with_oracle(const Mesh& mesh, const Viewpoint& viewpoint) {
  const Oracle oracle(mesh, viewpoint);
  const EdgeMap edges = exact_edges(mesh, viewpoint);
  const auto weight = [&](NodeId front, NodeId back) {
    const auto found = edges.find({front, back});
    return found == edges.end() ? 0.0 : found->second;
  };
  std::size_t judged = 0;
  for (std::uint32_t a = 0; a < mesh.triangles.size(); ++a) {
    for (std::uint32_t b = a + 1; b < mesh.triangles.size(); ++b) {
      const Oracle::Overlap expected = oracle.overlap(a, b);
      const double ab = weight(expected.node_a, expected.node_b);
      const double ba = weight(expected.node_b, expected.node_a);
      // However small: what is drawn is never more than the overlap.
      EXPECT_LE(ab + ba, expected.area + kSmallArea) << a << " " << b;
      if (expected.area < kSmallArea) continue;
      if (expected.a_ahead > kSmallDepth) {
        EXPECT_GT(ab, 0.0) << a << " before " << b;
      }
      if (expected.b_ahead > kSmallDepth) {
        EXPECT_GT(ba, 0.0) << b << " before " << a;
      }
      if (expected.a_ahead == 0) {
        EXPECT_EQ(ab, 0.0) << a << " behind " << b;
      }
      if (expected.b_ahead == 0) {
        EXPECT_EQ(ba, 0.0) << b << " behind " << a;
      }
      if (std::max(expected.a_ahead, expected.b_ahead) > kSmallDepth) {
        EXPECT_NEAR(ab + ba, expected.area, 1e-5 + 1e-3 * expected.area) << a << " " << b;
        ++judged;
      }
    }
  }
  return judged;
}

struct NamedMesh {
  std::string name;
  Mesh mesh;
  std::size_t least_judged;  // pairs per test, so that an oracle that sees nothing fails
};

std::vector<NamedMesh> oracle_meshes() {
  Mesh duplicates = random_soup(30, 0.7, 9);
  testing::append(duplicates, duplicates);
  Mesh plane_and_specks = random_soup(120, 0.01, 4);
  testing::append(plane_and_specks,
                  {{{-1, -1, 0.02F}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0.01F}}, {}, {{0, 1, 2}, {0, 2, 3}}});
  return {{"crossing soup", random_soup(60, 0.8, 1), 1000},
          {"sparse soup", random_soup(150, 0.2, 2), 100},
          {"icosphere", testing::icosphere_mesh(1), 100},
          {"nested spheres", testing::nested_spheres(1), 200},
          {"torus knot", testing::sample_mesh("torus-knot", 0.1, 300), 500},
          {"goblet", testing::sample_mesh("goblet", 0.1, 300), 300},
          {"coplanar stack", testing::sample_mesh("coplanar-stack", 0.05, 200), 10},
          {"duplicates", duplicates, 500},
          {"large and tiny", plane_and_specks, 30}};
}

TEST(ExactEdges, AgreeWithAllPairsInSpace) {
  Random random(11);
  for (const NamedMesh& named : oracle_meshes()) {
    SCOPED_TRACE(named.name);
    std::size_t judged = 0;
    for (const double distance : {1.3, 3.0, kInfiniteDistance}) {
      for (int i = 0; i < 2; ++i) judged += compare_with_oracle(named.mesh, {random.direction(), distance});
    }
    EXPECT_GT(judged, named.least_judged);
  }
}

TEST(ExactEdges, OnlyIntersectingFacesHideEachOtherBothWays) {
  OcclusionScratch scratch;
  ViewpointEdges edges;
  const auto both_ways = [&](const Mesh& mesh) {
    find_edges_exactly(scene_of(mesh), {normalized(Vec3d{1, 2, 3}), 2}, scratch, edges);
    const EdgeMap map = map_of(edges);
    std::uint64_t count = 0;
    for (const auto& [pair, area] : map) count += map.contains({pair.second, pair.first}) ? 1U : 0U;
    EXPECT_EQ(count % 2, 0U);
    return count / 2;
  };
  EXPECT_EQ(both_ways(testing::nested_spheres(2)), 0U);
  EXPECT_EQ(edges.intersecting, 0U);
  const std::uint64_t crossing = both_ways(random_soup(60, 0.8, 1));
  EXPECT_GT(crossing, 10U);
  EXPECT_NEAR(static_cast<double>(edges.intersecting), static_cast<double>(crossing), 2);
}

TEST(ExactEdges, ALargerToleranceLeavesASubset) {
  for (const Mesh& mesh : {random_soup(80, 0.5, 3), testing::sample_mesh("goblet", 0.1, 400)}) {
    const Viewpoint viewpoint{normalized(Vec3d{1, -1, 2}), 2.5};
    EdgeMap last = exact_edges(mesh, viewpoint, 0);
    const std::size_t all = last.size();
    for (const double tolerance : {0.001, 0.003, 0.01, 0.03, 0.1}) {
      const EdgeMap fewer = exact_edges(mesh, viewpoint, tolerance);
      for (const auto& [pair, area] : fewer) EXPECT_TRUE(last.contains(pair)) << tolerance;
      last = fewer;
    }
    EXPECT_LT(last.size(), all / 2);
  }
}

TEST(ExactEdges, FrontOnlyDropsWhatIsSeenFromBehind) {
  const Mesh mesh = testing::nested_spheres(1);
  OcclusionScene scene = scene_of(mesh);
  const Viewpoint viewpoint{{0, 0, 1}, 3};
  const EdgeMap both = exact_edges(mesh, viewpoint);
  scene.front_only = true;
  OcclusionScratch scratch;
  ViewpointEdges edges;
  find_edges_exactly(scene, viewpoint, scratch, edges);
  const EdgeMap front = map_of(edges);
  std::size_t expected = 0;
  for (const auto& [pair, area] : both) {
    const bool stays = !is_flipped(pair.first) && !is_flipped(pair.second);
    expected += stays ? 1U : 0U;
    EXPECT_EQ(front.contains(pair), stays);
  }
  EXPECT_EQ(front.size(), expected);
  EXPECT_GT(expected, 0U);
}

// ------------------------------------------------------------------------------------ against the raster

// Consecutive fragments of every pixel, with the pixels they take.
std::map<std::pair<NodeId, NodeId>, int> consecutive_fragments(const Mesh& mesh, const Viewpoint& viewpoint,
                                                               std::uint32_t size) {
  FragmentBuffer buffer;
  rasterize(mesh, look_at_sphere(bounding_sphere(mesh), viewpoint, size, size), {}, buffer);
  std::map<std::pair<NodeId, NodeId>, int> pairs;
  for (std::uint64_t p = 0; p < std::uint64_t{size} * size; ++p) {
    const std::span<const Fragment> fragments = buffer.pixel(p);
    for (std::size_t i = 0; i + 1 < fragments.size(); ++i) {
      if (fragments[i + 1].depth - fragments[i].depth > 10 * kDepthTie)
        ++pairs[{fragments[i].node, fragments[i + 1].node}];
    }
  }
  return pairs;
}

// The raster snaps corners to 1/256 pixel, so that at outlines and where faces meet single pixels may differ.
constexpr double kSnappedShare = 0.002;

void expect_the_raster_agrees(const Mesh& mesh) {
  Random random(6);
  std::uint64_t pixels = 0;
  std::uint64_t missing = 0;
  for (const double distance : {1.5, 3.0, kInfiniteDistance}) {
    const Viewpoint viewpoint{random.direction(), distance};
    const EdgeMap exact = exact_edges(mesh, viewpoint);
    for (const auto& [pair, count] : consecutive_fragments(mesh, viewpoint, 256)) {
      pixels += static_cast<std::uint64_t>(count);
      if (exact.contains(pair)) continue;
      missing += static_cast<std::uint64_t>(count);
      EXPECT_LE(count, 2) << "more than an outline: " << pair.first << " before " << pair.second;
    }
  }
  EXPECT_GT(pixels, 10000U);
  EXPECT_LE(static_cast<double>(missing), kSnappedShare * static_cast<double>(pixels));
}

TEST(ExactEdges, HoldTheRastersOrderOfASample) {
  expect_the_raster_agrees(testing::sample_mesh("torus-knot", 0.3, 2000));
  expect_the_raster_agrees(testing::sample_mesh("goblet", 0.3, 2000));
}

TEST(ExactEdges, HoldTheRastersOrderOfAScan) {
  const std::string path = std::string(PELLUCID_MODELS) + "/static/bunny_10k.obj";
  const Mesh bunny = testing::read_plain_obj(path);
  if (bunny.triangles.empty()) GTEST_SKIP() << "development model missing: " << path;
  expect_the_raster_agrees(simplify(bunny, 2000));
}

EdgeMap raster_edges(const Mesh& mesh, const Viewpoint& viewpoint, std::uint32_t size) {
  OcclusionScene scene = scene_of(mesh);
  scene.raster_size = size;
  OcclusionScratch scratch;
  ViewpointEdges edges;
  find_edges_by_raster(scene, viewpoint, scratch, edges);
  return map_of(edges);
}

TEST(RasterEdges, AreExactEdgesButForOutlines) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.2, 1000);
  for (const double distance : {2.0, kInfiniteDistance}) {
    const Viewpoint viewpoint{normalized(Vec3d{3, 1, 2}), distance};
    const EdgeMap exact = exact_edges(mesh, viewpoint);
    double all = 0;
    double foreign = 0;
    for (const auto& [pair, area] : raster_edges(mesh, viewpoint, 512)) {
      all += area;
      if (!exact.contains(pair)) foreign += area;
    }
    EXPECT_GT(all, 0.5);
    EXPECT_LE(foreign, kSnappedShare * all);
  }
}

TEST(RasterEdges, AreasAreThoseOfTheImage) {
  // Two squares, the nearer one in front of the middle: the exact areas within a row of pixels.
  Mesh mesh{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}}, {}, {{0, 1, 2}}};
  testing::append(mesh, {{{-0.2F, -0.6F, 0.5F}, {0.6F, -0.6F, 0.5F}, {0.6F, 0.2F, 0.5F}}, {}, {{0, 1, 2}}});
  for (const double distance : {1.5, 4.0, kInfiniteDistance}) {
    const EdgeMap exact = exact_edges(mesh, {{0, 0, 1}, distance});
    const EdgeMap raster = raster_edges(mesh, {{0, 0, 1}, distance}, 512);
    ASSERT_EQ(exact.size(), 1U);
    ASSERT_EQ(raster.size(), 1U);
    EXPECT_EQ(exact.begin()->first, raster.begin()->first);
    EXPECT_NEAR(exact.begin()->second, raster.begin()->second, 0.02 * exact.begin()->second) << distance;
  }
}

TEST(RasterEdges, CoincidentFacesBothHideWhatIsBehind) {
  // Two equal triangles before one: ties make no edge between the two, but both lie before the third.
  Mesh mesh{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -1, 0.5F}, {1, -1, 0.5F}, {0, 1, 0.5F}},
            {},
            {{0, 1, 2}, {3, 4, 5}, {3, 4, 5}}};
  for (const double z : {1.0, -1.0}) {
    const Viewpoint viewpoint{{0, 0, z}, 3};
    const EdgeMap exact = exact_edges(mesh, viewpoint);
    const EdgeMap raster = raster_edges(mesh, viewpoint, 256);
    ASSERT_EQ(exact.size(), 2U);
    for (const auto& [pair, area] : exact) EXPECT_TRUE(raster.contains(pair)) << pair.first << pair.second;
    EXPECT_EQ(raster.size(), 2U);
  }
}

}  // namespace
}  // namespace pellucid
