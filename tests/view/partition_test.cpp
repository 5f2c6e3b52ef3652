// Tests view partitions: counts, shared samples, neighbours, names, and the cell that contains a direction.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "pellucid/view.h"

namespace pellucid {
namespace {

constexpr std::uint32_t power_of_4(std::uint32_t n) {
  return 1U << (2U * n);
}

PartitionSpec sampled(std::uint32_t level, std::uint32_t sample_level) {
  return {PartitionKind::sampled_triangles, level, sample_level};
}
PartitionSpec viewpoints(std::uint32_t level) {
  return {PartitionKind::viewpoints, level, 0};
}

double triple_product(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(a, cross(b, c));
}

// Returns the solid angle of a spherical triangle (Van Oosterom, Strackee, 1983).
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(triple_product(a, b, c), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

std::string message_of(const std::string& text) {
  try {
    parse_partition(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
    return error.what();
  }
  return "accepted";
}

TEST(Icosphere, HasTheExpectedCountsAtEveryLevel) {
  for (std::uint32_t level = 0; level <= 6; ++level) {
    const Icosphere sphere = make_icosphere(level);
    EXPECT_EQ(sphere.vertices.size(), 10 * power_of_4(level) + 2);
    EXPECT_EQ(sphere.triangles.size(), 20 * power_of_4(level));
  }
  EXPECT_THROW(make_icosphere(10), Error);
}

TEST(Icosphere, TilesTheSphereWithOutwardTriangles) {
  for (std::uint32_t level = 0; level <= 5; ++level) {
    const Icosphere sphere = make_icosphere(level);
    for (const Vec3d& v : sphere.vertices) EXPECT_NEAR(length(v), 1, 4e-16);

    double covered = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed_edges;
    for (const auto& [a, b, c] : sphere.triangles) {
      const double angle = solid_angle(sphere.vertices[a], sphere.vertices[b], sphere.vertices[c]);
      EXPECT_GT(angle, 0);
      covered += angle;
      ++directed_edges[{a, b}];
      ++directed_edges[{b, c}];
      ++directed_edges[{c, a}];
    }
    EXPECT_NEAR(covered, 4 * 3.14159265358979323846, 1e-9);
    for (const auto& [edge, count] : directed_edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(directed_edges.count({edge.second, edge.first}), 1U);
    }
  }
}

TEST(Icosphere, ChildrenLieInTheirParentWithCornersFirst) {
  const Icosphere coarse = make_icosphere(2);
  const Icosphere fine = make_icosphere(3);
  for (std::size_t f = 0; f < coarse.triangles.size(); ++f) {
    const auto& parent = coarse.triangles[f];
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(fine.triangles[4 * f + k][k], parent[k]);
    for (const std::uint32_t middle : fine.triangles[4 * f + 3]) EXPECT_GE(middle, coarse.vertices.size());
  }
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) EXPECT_EQ(fine.vertices[v], coarse.vertices[v]);
}

TEST(Icosphere, HasOnlyAcuteTriangles) {
  const Icosphere sphere = make_icosphere(6);
  for (const auto& triangle : sphere.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& corner = sphere.vertices[triangle[k]];
      const Vec3d one = sphere.vertices[triangle[(k + 1) % 3]] - corner;
      const Vec3d other = sphere.vertices[triangle[(k + 2) % 3]] - corner;
      ASSERT_GT(dot(one, other), 0);
    }
  }
}

TEST(Partition, S22HasTheCountsOfThePaper) {
  const ViewPartition partition = make_partition(sampled(2, 2));
  EXPECT_EQ(partition.cell_count(), 320U);
  EXPECT_EQ(partition.samples.size(), 2562U);
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c) EXPECT_EQ(partition.samples_of(c).size(), 15U);
}

TEST(Partition, SampledTrianglesHaveTheExpectedCountsAtEveryLevel) {
  for (std::uint32_t n = 0; n <= 3; ++n) {
    for (std::uint32_t m = 0; m <= 3; ++m) {
      const ViewPartition partition = make_partition(sampled(n, m));
      const std::uint32_t side = (1U << m) + 1;
      ASSERT_EQ(partition.cell_count(), 20 * power_of_4(n));
      ASSERT_EQ(partition.corners.size(), partition.cell_count());
      ASSERT_EQ(partition.samples.size(), 10 * power_of_4(n + m) + 2);
      std::set<std::uint32_t> used;
      for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
        ASSERT_EQ(partition.samples_of(c).size(), side * (side + 1) / 2);
        ASSERT_EQ(partition.neighbors_of(c).size(), 3U);
        used.insert(partition.samples_of(c).begin(), partition.samples_of(c).end());
      }
      EXPECT_EQ(used.size(), partition.samples.size());
    }
  }
}

TEST(Partition, SamplesLieInTheirCellsAndNeighborsShareAWholeBorder) {
  const std::uint32_t m = 2;
  const ViewPartition partition = make_partition(sampled(2, m));
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
    const auto& [a, b, d] = partition.corners[c];
    for (const std::uint32_t s : partition.samples_of(c)) {
      const Vec3d& sample = partition.samples[s];
      EXPECT_GE(triple_product(a, b, sample), -1e-15);
      EXPECT_GE(triple_product(b, d, sample), -1e-15);
      EXPECT_GE(triple_product(d, a, sample), -1e-15);
    }
    for (const std::uint32_t other : partition.neighbors_of(c)) {
      std::vector<std::uint32_t> shared;
      std::ranges::set_intersection(partition.samples_of(c), partition.samples_of(other),
                                    std::back_inserter(shared));
      EXPECT_EQ(shared.size(), (1U << m) + 1);
    }
  }
}

TEST(Partition, ViewpointCellsHaveFiveOrSixNeighbors) {
  for (std::uint32_t n = 0; n <= 3; ++n) {
    const ViewPartition partition = make_partition(viewpoints(n));
    ASSERT_EQ(partition.cell_count(), 10 * power_of_4(n) + 2);
    ASSERT_EQ(partition.samples.size(), partition.cell_count());
    std::uint32_t fives = 0;
    for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
      ASSERT_EQ(partition.samples_of(c).size(), 1U);
      EXPECT_EQ(partition.samples[partition.samples_of(c)[0]], cell_direction(partition, c));
      const std::size_t count = partition.neighbors_of(c).size();
      EXPECT_TRUE(count == 5 || count == 6);
      fives += count == 5 ? 1 : 0;
    }
    EXPECT_EQ(fives, 12U);
  }
}

TEST(Partition, NeighborsAreSortedAndMutual) {
  for (const PartitionSpec& spec : {sampled(2, 0), viewpoints(2)}) {
    const ViewPartition partition = make_partition(spec);
    for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
      const auto neighbors = partition.neighbors_of(c);
      EXPECT_TRUE(std::ranges::is_sorted(neighbors));
      for (const std::uint32_t other : neighbors) {
        EXPECT_NE(other, c);
        EXPECT_TRUE(std::ranges::binary_search(partition.neighbors_of(other), c));
      }
    }
  }
}

TEST(Partition, CapsContainTheirCellsAndLittleMore) {
  const ViewPartition partition = make_partition(viewpoints(2));
  std::vector<double> farthest(partition.cell_count(), 1.0);
  Random random(11);
  for (int i = 0; i < 200000; ++i) {
    const Vec3d d = random.direction();
    const std::uint32_t c = find_cell(partition, d);
    farthest[c] = std::min(farthest[c], dot(partition.samples[c], d));
  }
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
    EXPECT_GE(farthest[c], partition.cap_cosines[c]);
    EXPECT_LT(std::acos(partition.cap_cosines[c]), 1.1 * std::acos(farthest[c]));
  }
}

TEST(Partition, MiddleOfACellLiesInIt) {
  for (const PartitionSpec& spec : {sampled(3, 0), viewpoints(3)}) {
    const ViewPartition partition = make_partition(spec);
    for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
      EXPECT_EQ(find_cell_brute_force(partition, cell_direction(partition, c)), c);
      EXPECT_EQ(find_cell(partition, cell_direction(partition, c)), c);
    }
  }
}

TEST(Partition, CornersBelongToTheLowestCellThatTouchesThem) {
  const ViewPartition partition = make_partition(sampled(2, 0));
  for (std::uint32_t s = 0; s < partition.samples.size(); ++s) {
    std::uint32_t lowest = 0;
    while (!std::ranges::binary_search(partition.samples_of(lowest), s)) ++lowest;
    EXPECT_EQ(find_cell(partition, partition.samples[s]), lowest);
    EXPECT_EQ(find_cell_brute_force(partition, partition.samples[s]), lowest);
  }
}

TEST(PartitionName, IsParsedInAllForms) {
  EXPECT_EQ(parse_partition("S2,2"), sampled(2, 2));
  EXPECT_EQ(parse_partition("S[3,1]"), sampled(3, 1));
  EXPECT_EQ(parse_partition("s0,4"), sampled(0, 4));
  EXPECT_EQ(parse_partition("P4"), viewpoints(4));
  EXPECT_EQ(parse_partition("p[0]"), viewpoints(0));
  EXPECT_EQ(parse_partition("T3"), (PartitionSpec{PartitionKind::view_triangles, 3, kSolidSampleLevel}));
  EXPECT_EQ(parse_partition("t[2]"), (PartitionSpec{PartitionKind::view_triangles, 2, kSolidSampleLevel}));
  EXPECT_EQ(parse_partition("R2"), (PartitionSpec{PartitionKind::view_regions, 2, kSolidSampleLevel}));
  EXPECT_EQ(parse_partition("r[0]"), (PartitionSpec{PartitionKind::view_regions, 0, kSolidSampleLevel}));
}

TEST(PartitionName, SurvivesARoundTrip) {
  for (const char* text : {"S0,0", "S2,2", "S5,4", "P0", "P5", "T0", "T3", "R2", "R5"}) {
    EXPECT_EQ(to_string(parse_partition(text)), text);
  }
}

TEST(PartitionName, IsRejectedWithTheAcceptedForms) {
  for (const char* text : {"",       "S",     "S2",  "S2,", "S2,5",  "S6,0", "S2;2",  "S[2,2",
                           "[S2,2]", "S2,2]", "P",   "P6",  "P-1",   "P10",  "P[2]]", "T6",
                           "R",      "T2,2",  "R[2", "Q2",  "S2,2 ", "[",    "P[",    "S\xc3\xa9,1"}) {
    const std::string message = message_of(text);
    EXPECT_NE(message.find(std::string("'") + text + "'"), std::string::npos) << message;
    EXPECT_NE(message.find("S<n>,<m>"), std::string::npos) << message;
  }
}

TEST(Partition, TrianglesAndRegionsHaveTheCellsAndSamplesOfS) {
  const ViewPartition sampled_cells = make_partition(sampled(2, 2));
  for (const PartitionKind kind : {PartitionKind::view_triangles, PartitionKind::view_regions}) {
    const ViewPartition partition = make_partition({kind, 2, kSolidSampleLevel});
    EXPECT_TRUE(is_continuous(partition.spec));
    EXPECT_TRUE(has_triangle_cells(partition.spec));
    EXPECT_EQ(partition.corners, sampled_cells.corners);
    EXPECT_EQ(partition.samples, sampled_cells.samples);
    EXPECT_EQ(partition.cell_samples, sampled_cells.cell_samples);
    EXPECT_EQ(partition.neighbors, sampled_cells.neighbors);
    Random random(3);
    for (int i = 0; i < 500; ++i) {
      const Vec3d d = random.direction();
      EXPECT_EQ(find_cell(partition, d), find_cell(sampled_cells, d));
      EXPECT_EQ(find_cell_brute_force(partition, d), find_cell(sampled_cells, d));
      const std::uint32_t cell = find_cell(partition, random.direction());
      EXPECT_EQ(max_cosine(partition, cell, d), max_cosine(sampled_cells, cell, d));
    }
  }
}

TEST(PartitionName, LevelsOutOfRangeAreRejectedInSpecsToo) {
  EXPECT_THROW(make_partition(sampled(6, 0)), Error);
  EXPECT_THROW(make_partition(sampled(0, 5)), Error);
  EXPECT_THROW(make_partition(viewpoints(6)), Error);
  EXPECT_THROW(make_partition({PartitionKind::view_triangles, 6, kSolidSampleLevel}), Error);
  EXPECT_THROW(make_partition({PartitionKind::view_regions, 2, 1}), Error);
}

}  // namespace
}  // namespace pellucid
