// Tests the edges of T[n] and R[n]: nothing that a viewpoint of the cell sees is missing, almost nothing is
// superfluous, and some scenes have known answers.
#include "transparency/graph/region_edges.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "order_helpers.h"
#include "pellucid/baseline.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

using testing::EdgeMap;

struct Distances {
  double from, to;
};
constexpr Distances kSolids[] = {
    {1.5, kInfiniteDistance}, {1.2, 4.0}, {3.0, 3.0}, {kInfiniteDistance, kInfiniteDistance}};

EdgeRows no_edges(const Mesh& mesh) {
  EdgeRows rows;
  rows.offsets.assign(2 * mesh.triangles.size() + 1, 0);
  return rows;
}

// Edges of one cell from geometry alone.
EdgeRows region_of(const Mesh& mesh, const std::vector<Vec3d>& positions, const ViewPartition& partition,
                   std::uint32_t cell, Distances distances, double tolerance = 0) {
  return RegionEdges(mesh.triangles, positions, partition, false, tolerance, distances.from, distances.to)
      .complete(cell, no_edges(mesh));
}

EdgeMap region_of(const Mesh& mesh, const ViewPartition& partition, std::uint32_t cell, Distances distances,
                  double tolerance = 0) {
  return testing::map_of(
      region_of(mesh, unit_positions(mesh, bounding_sphere(mesh)), partition, cell, distances, tolerance));
}

ViewPartition triangles_of_level(std::uint32_t level) {
  return make_partition({PartitionKind::view_triangles, level, kSolidSampleLevel});
}

Viewpoint random_viewpoint(const std::array<Vec3d, 3>& corners, Distances distances, Random& random) {
  const double a = random.uniform(0, 1);
  const double b = random.uniform(0, 1) * (1 - a);
  const Vec3d direction = normalized(corners[0] * a + corners[1] * b + corners[2] * (1 - a - b));
  return {direction, 1 / random.uniform(1 / distances.to, 1 / distances.from)};
}

// The edges of a viewpoint, heavier than a limit, found by projection.
EdgeMap edges_from(const Mesh& mesh, const std::vector<Vec3d>& positions, const Viewpoint& viewpoint,
                   double least) {
  const OcclusionScene scene{mesh, {{}, 1}, positions, false, 0, 0};
  OcclusionScratch scratch;
  ViewpointEdges edges;
  find_edges_exactly(scene, viewpoint, scratch, edges);
  EdgeMap found;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i) {
      const auto area = static_cast<double>(edges.areas[i]);
      if (area > least) found[{node_of(t, edges.front_flipped[t] != 0), edges.backs[i]}] = area;
    }
  }
  return found;
}

// ------------------------------------------------------------------------------------- nothing is missing

void expect_no_viewpoint_sees_more(const Mesh& mesh, const ViewPartition& partition, std::uint32_t cell,
                                   Distances distances, int viewpoints, Random& random) {
  const std::vector<Vec3d> positions = unit_positions(mesh, bounding_sphere(mesh));
  const EdgeMap region = region_of(mesh, partition, cell, distances);
  for (int i = 0; i < viewpoints; ++i) {
    const Viewpoint viewpoint = random_viewpoint(partition.corners[cell], distances, random);
    for (const auto& [pair, area] : edges_from(mesh, positions, viewpoint, 1e-7)) {
      ASSERT_TRUE(region.contains(pair))
          << pair.first << " -> " << pair.second << ", area " << area << ", cell " << cell << ", distance "
          << viewpoint.distance << " of " << distances.from << " .. " << distances.to;
    }
  }
}

TEST(RegionEdges, NoViewpointSeesAnEdgeThatIsMissing) {
  Random random(1);
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    // Soups: many intersections, some thin faces.
    const Mesh mesh = testing::random_soup(40, seed % 2 == 0 ? 0.5 : 0.2, seed);
    for (const std::uint32_t level : {0U, 1U, 2U}) {
      const ViewPartition partition = triangles_of_level(level);
      for (const Distances& distances : kSolids) {
        const auto cell = static_cast<std::uint32_t>(random.below(partition.cell_count()));
        expect_no_viewpoint_sees_more(mesh, partition, cell, distances, 60, random);
      }
    }
  }
}

TEST(RegionEdges, NoViewpointSeesAnEdgeThatIsMissingOnConnectedMeshes) {
  Random random(2);
  for (const char* name : {"goblet", "torus-knot"}) {
    const Mesh mesh = testing::sample_mesh(name, 0.3, 250);
    for (const std::uint32_t level : {1U, 2U}) {
      const ViewPartition partition = triangles_of_level(level);
      for (const Distances& distances : kSolids) {
        const auto cell = static_cast<std::uint32_t>(random.below(partition.cell_count()));
        expect_no_viewpoint_sees_more(mesh, partition, cell, distances, 60, random);
      }
    }
  }
}

// --------------------------------------------------------------------------------- next to nothing too much

// A viewpoint well inside the part of the solid that a pair of faces leaves.
Viewpoint witness(const ViewPolytope& viewpoints, const ViewSolid& solid) {
  Eye middle{{}, 0};
  Eye farthest{{}, 1};
  for (const ViewPolytope::Vertex& v : viewpoints.vertices()) {
    middle = {middle.at + v.eye.at, middle.w + v.eye.w};
    if (length(v.eye.at) * farthest.w > length(farthest.at) * v.eye.w) farthest = v.eye;
  }
  const auto count = static_cast<double>(viewpoints.vertices().size());
  middle = {middle.at / count, middle.w / count};
  // The hollow of the solid: go towards the farthest vertex until it is left.
  for (int step = 0; step < 30 && length(middle.at) < solid.from * middle.w; ++step) {
    middle = {(middle.at + farthest.at) / 2, (middle.w + farthest.w) / 2};
  }
  return {normalized(middle.at), middle.w > 0 ? length(middle.at) / middle.w : kInfiniteDistance};
}

std::array<SolidFace, 2> faces_of(const Mesh& mesh, const std::vector<Vec3d>& positions, NodeId a, NodeId b) {
  std::array<SolidFace, 2> faces;
  for (std::size_t i = 0; i < 2; ++i) {
    const Triangle corners = corners_of(mesh, i == 0 ? a : b);
    for (std::size_t k = 0; k < 3; ++k) faces[i].corners[k] = positions[corners[k]];
    const auto& [p, q, r] = faces[i].corners;
    faces[i].front.normal = normalized(cross(q - p, r - p));
    faces[i].front.offset = -dot(faces[i].front.normal, p);
  }
  return faces;
}

TEST(RegionEdges, NearlyAllHaveAViewpointThatSeesThem) {
  Random random(3);
  std::uint64_t edges = 0;
  std::uint64_t seen = 0;
  for (std::uint64_t seed = 10; seed < 16; ++seed) {
    const Mesh mesh =
        seed % 2 == 0 ? testing::random_soup(60, 0.3, seed) : testing::sample_mesh("torus-knot", 0.3, 120);
    const std::vector<Vec3d> positions = unit_positions(mesh, bounding_sphere(mesh));
    const ViewPartition partition = triangles_of_level(static_cast<std::uint32_t>(seed % 3));
    for (const Distances& distances : kSolids) {
      const auto cell = static_cast<std::uint32_t>(random.below(partition.cell_count()));
      const ViewSolid solid = make_view_solid(partition.corners[cell], distances.from, distances.to);
      for (const auto& [pair, weight] : region_of(mesh, partition, cell, distances)) {
        const auto [front, back] = faces_of(mesh, positions, pair.first, pair.second);
        ViewPolytope viewpoints;
        find_hiding_viewpoints(solid, front, back, viewpoints);
        ASSERT_TRUE(solid.holds_part_of(viewpoints));
        const Mesh two{mesh.positions, {}, {mesh.triangles[pair.first / 2], mesh.triangles[pair.second / 2]}};
        const EdgeMap shown = edges_from(two, positions, witness(viewpoints, solid), 0);
        ++edges;
        seen += shown.contains({pair.first % 2, 2 + pair.second % 2}) ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(edges, 10000U);
  EXPECT_GT(static_cast<double>(seen), 0.98 * static_cast<double>(edges)) << seen << " of " << edges;
}

// ------------------------------------------------------------------------------------------- known answers

// A strip over another, both wide; the lower one begins `gap` beyond the end of the upper one, in direction
// `across`, and lies `below` it. Orthographic views hide it where they tilt by more than gap / below.
Mesh two_strips() {
  return {{}, {}, {{0, 1, 2}, {3, 4, 5}}};
}
std::vector<Vec3d> strip_positions(const Vec3d& axis, const Vec3d& across, double gap, double below) {
  const Vec3d along = cross(axis, across);
  const auto at = [&](double x, double y, double z) { return across * x + along * y + axis * z; };
  return {at(0, -9, below), at(0, 9, below), at(-9, 0, below),
          at(gap, 9, 0),    at(gap, -9, 0),  at(gap + 9, 0, 0)};
}

TEST(RegionEdges, AppearWhereTheTiltOfTheCellReaches) {
  for (const std::uint32_t level : {0U, 1U, 2U}) {
    const ViewPartition partition = triangles_of_level(level);
    for (std::uint32_t cell = 0; cell < 20; cell += 3) {
      const std::array<Vec3d, 3>& corners = partition.corners[cell];
      const Vec3d axis = normalized(corners[0] + corners[1] + corners[2]);
      const Vec3d across = normalized(cross(axis, {0.3, -0.5, 0.8}));
      const double below = 0.4;
      double reach = -HUGE_VAL;
      for (const Vec3d& d : corners) reach = std::max(reach, -below * dot(d, across) / dot(d, axis));
      for (const double beyond : {-1e-4, 1e-4}) {
        const EdgeMap edges =
            testing::map_of(region_of(two_strips(), strip_positions(axis, across, reach + beyond, below),
                                      partition, cell, {kInfiniteDistance, kInfiniteDistance}));
        EXPECT_EQ(edges.size(), beyond < 0 ? 1U : 0U) << level << ' ' << cell;
      }
    }
  }
}

TEST(RegionEdges, PerspectiveReachesFurtherFromNearby) {
  // Straight above the gap's far end there is the point (x, 0, z); it hides the lower strip where x < 0 ...
  // in similar triangles: gap / below <= -x / (z - below).
  const ViewPartition partition = triangles_of_level(2);
  const std::array<Vec3d, 3>& corners = partition.corners[7];
  const Vec3d axis = normalized(corners[0] + corners[1] + corners[2]);
  const Vec3d across = normalized(cross(axis, {0.3, -0.5, 0.8}));
  for (const double distance : {1.5, 2.0, 5.0}) {
    const double below = 0.5;
    double reach = -HUGE_VAL;
    for (int i = 0; i <= 400; ++i) {
      for (int j = 0; i + j <= 400; ++j) {
        const Vec3d d = normalized(corners[0] * i + corners[1] * j + corners[2] * (400 - i - j)) * distance;
        reach = std::max(reach, -below * dot(d, across) / (dot(d, axis) - below));
      }
    }
    const auto edges_at = [&](double gap) {
      return region_of(two_strips(), strip_positions(axis, across, gap, below), partition, 7,
                       {distance, distance})
          .edge_count();
    };
    EXPECT_EQ(edges_at(0.999 * reach), 1U) << distance;
    // The solid is held in a frustum, 2 % longer: it errs by no more.
    EXPECT_EQ(edges_at(1.05 * reach), 0U) << distance;
    EXPECT_EQ(edges_at(0.999 * reach), 1U);
  }
}

TEST(RegionEdges, NearerThanTheLeastDistanceDoesNotCount) {
  // A tiny face hides another along a line that leaves the cell through the middle of a side, at a distance
  // of 1.65 / cos 20.9 degrees: nearer than 2, though beyond the plane through the corners at 2.
  const ViewPartition partition = triangles_of_level(0);
  const std::array<Vec3d, 3>& corners = partition.corners[0];
  const Vec3d axis = normalized(corners[0] + corners[1] + corners[2]);
  const Vec3d side = corners[0] + corners[1];
  const Vec3d outward = normalized(side - axis * dot(side, axis));
  const Vec3d along = cross(outward, axis);
  std::vector<Vec3d> positions;
  for (const double behind : {0.0, 0.3}) {
    const Vec3d middle = axis * 1.65 - outward * behind;
    for (const auto& [x, y] : {std::pair{-0.005, -0.005}, {0.005, -0.005}, {0.0, 0.005}}) {
      positions.push_back(middle - along * x + axis * y);
    }
  }
  const Mesh mesh{{}, {}, {{0, 1, 2}, {3, 4, 5}}};
  const auto found = [&](double from) {
    return testing::map_of(region_of(mesh, positions, partition, 0, {from, kInfiniteDistance}))
        .contains({node_of(0, false), node_of(1, false)});
  };
  EXPECT_TRUE(found(1.7));
  EXPECT_FALSE(found(2));
}

TEST(RegionEdges, AFaceHidesWhatLiesBehindItAndNothingElse) {
  // From above: 0 over 1. Both look up. The flipped ones are seen from below, the other way round.
  const Mesh mesh{{{-1, -1, 0.5F}, {1, -1, 0.5F}, {0, 1, 0.5F}, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
                  {},
                  {{0, 1, 2}, {3, 4, 5}}};
  const ViewPartition partition = triangles_of_level(2);
  const std::uint32_t above = find_cell(partition, {0.01, 0.02, 1});
  const std::uint32_t under = find_cell(partition, {0.01, 0.02, -1});
  for (const Distances& distances : kSolids) {
    EXPECT_EQ(region_of(mesh, partition, above, distances), (EdgeMap{{{0, 2}, kUnseenWeight}}));
    EXPECT_EQ(region_of(mesh, partition, under, distances), (EdgeMap{{{3, 1}, kUnseenWeight}}));
  }
}

TEST(RegionEdges, FacesThatIntersectHideEachOther) {
  const Mesh mesh{
      {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -0.5F, -0.3F}, {1, -0.5F, -0.3F}, {0, 0.5F, 0.3F}},
      {},
      {{0, 1, 2}, {3, 4, 5}}};
  const ViewPartition partition = triangles_of_level(2);
  const std::uint32_t above = find_cell(partition, {0.01, 0.02, 1});
  const EdgeMap edges = region_of(mesh, partition, above, {2, 4});
  EXPECT_TRUE(edges.contains({0, 2}));
  EXPECT_TRUE(edges.contains({2, 0}));
}

TEST(RegionEdges, ConvexBodiesHideOnlyTheirOwnBacks) {
  // Also where neighbours are nearly coplanar: rounding makes no edges.
  for (const std::uint32_t level : {0U, 1U, 2U}) {
    const Mesh mesh = testing::icosphere_mesh(level);
    const ViewPartition partition = triangles_of_level(1);
    for (const std::uint32_t cell : {0U, 33U, 79U}) {
      const EdgeMap edges = region_of(mesh, partition, cell, {1.5, kInfiniteDistance});
      EXPECT_FALSE(edges.empty());
      for (const auto& [pair, weight] : edges) {
        EXPECT_FALSE(is_flipped(pair.first));
        EXPECT_TRUE(is_flipped(pair.second));
      }
    }
  }
}

TEST(RegionEdges, OnePlaneHidesNothing) {
  Random random(5);
  for (int turn = 0; turn < 4; ++turn) {
    const Vec3d x = random.direction();
    const Vec3d y = normalized(cross(x, random.direction()));
    Mesh mesh;
    for (std::uint32_t i = 0; i < 36; ++i) {
      const std::uint32_t column = i % 6;
      const std::uint32_t row = i / 6;
      mesh.positions.push_back(to_float(x * (column * 0.2 - 0.5) + y * (row * 0.2 - 0.5)));
      if (column == 5 || row == 5) continue;
      mesh.triangles.push_back({i, i + 1, i + 7});
      mesh.triangles.push_back({i, i + 7, i + 6});
    }
    const ViewPartition partition = triangles_of_level(1);
    for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
      EXPECT_TRUE(region_of(mesh, partition, cell, {1.5, kInfiniteDistance}).empty()) << cell;
    }
  }
}

TEST(RegionEdges, AFaceThatIsDoubledHidesTheSameTwice) {
  Mesh mesh = testing::nested_spheres(0);
  const std::size_t once = mesh.triangles.size();
  mesh.triangles.push_back(mesh.triangles[0]);
  const ViewPartition partition = triangles_of_level(1);
  const EdgeMap edges = region_of(mesh, partition, 5, {2, 4});
  for (const auto& [pair, weight] : edges) {
    if (triangle_of(pair.first) == 0) {
      EXPECT_TRUE(
          edges.contains({node_of(static_cast<std::uint32_t>(once), is_flipped(pair.first)), pair.second}));
    }
    EXPECT_FALSE(triangle_of(pair.first) == 0 && triangle_of(pair.second) == once);
  }
}

// ------------------------------------------------------------------------------------------- relations

OcclusionGraph graph_of(const Mesh& mesh, PartitionKind kind, Distances solid, double tolerance = 0) {
  GraphOptions options;
  options.distances = {1.5, 4};
  options.solid_from = solid.from;
  options.solid_to = solid.to;
  options.tolerance = tolerance;
  options.least_weight = 3e-7F;
  return build_occlusion_graph(mesh, bounding_sphere(mesh), make_partition({kind, 1, kSolidSampleLevel}),
                               options);
}

TEST(RegionEdges, RegionsHoldTrianglesHoldSamples) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.3, 200);
  const OcclusionGraph samples = graph_of(mesh, PartitionKind::sampled_triangles, {});
  const OcclusionGraph triangles = graph_of(mesh, PartitionKind::view_triangles, {1.5, 4});
  const OcclusionGraph regions = graph_of(mesh, PartitionKind::view_regions, {1, kInfiniteDistance});
  std::uint64_t more = 0;
  for (std::size_t cell = 0; cell < samples.cells.size(); ++cell) {
    const EdgeMap s = testing::map_of(samples.cells[cell]);
    const EdgeMap t = testing::map_of(triangles.cells[cell]);
    const EdgeMap r = testing::map_of(regions.cells[cell]);
    for (const auto& [pair, weight] : s) {
      ASSERT_TRUE(t.contains(pair));
      EXPECT_EQ(t.at(pair), weight);  // the samples say what it weighs
    }
    for (const auto& [pair, weight] : t) ASSERT_TRUE(r.contains(pair)) << pair.first << ' ' << pair.second;
    for (const auto& [pair, weight] : r)
      EXPECT_GE(weight, 0.99 * static_cast<double>(kUnseenWeight));  // stored in 16 bits
    EXPECT_GT(t.size(), s.size());
    EXPECT_GT(r.size(), t.size());
    more += r.size() - s.size();
    const EdgeRows rows = regions.cells[cell].expanded();
    for (NodeId node = 0; node < regions.node_count; ++node) {
      ASSERT_TRUE(std::is_sorted(rows.backs.begin() + rows.offsets[node],
                                 rows.backs.begin() + rows.offsets[node + 1]));
    }
  }
  EXPECT_GT(more, 0U);
}

TEST(RegionEdges, ALargerToleranceLeavesFewer) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.3, 200);
  const ViewPartition partition = triangles_of_level(1);
  EdgeMap before = region_of(mesh, partition, 11, {1.5, 4});
  for (const double tolerance : {0.003, 0.01, 0.03}) {
    const EdgeMap edges = region_of(mesh, partition, 11, {1.5, 4}, tolerance);
    EXPECT_LT(edges.size(), before.size());
    for (const auto& [pair, weight] : edges) EXPECT_TRUE(before.contains(pair));
    before = edges;
  }
  EXPECT_TRUE(region_of(mesh, partition, 11, {1.5, 4}, 1.0).empty());
}

TEST(RegionEdges, ThreadsDoNotMatter) {
  const Mesh mesh = testing::random_soup(50, 0.4, 4);
  const OcclusionGraph many = graph_of(mesh, PartitionKind::view_triangles, {1.5, 4});
  const ThreadLimit one(1);
  const OcclusionGraph single = graph_of(mesh, PartitionKind::view_triangles, {1.5, 4});
  for (std::size_t cell = 0; cell < many.cells.size(); ++cell) {
    EXPECT_EQ(testing::map_of(many.cells[cell]), testing::map_of(single.cells[cell]));
  }
}

TEST(RegionEdges, SingleSidedMeshesHaveNoFlippedNodes) {
  const Mesh mesh = testing::nested_spheres(1);
  const ViewPartition partition = triangles_of_level(1);
  const RegionEdges region(mesh.triangles, unit_positions(mesh, bounding_sphere(mesh)), partition, true, 0,
                           1.5, 4);
  const EdgeMap edges = testing::map_of(region.complete(3, no_edges(mesh)));
  EXPECT_FALSE(edges.empty());
  for (const auto& [pair, weight] : edges) EXPECT_FALSE(is_flipped(pair.first) || is_flipped(pair.second));
}

}  // namespace
}  // namespace pellucid
