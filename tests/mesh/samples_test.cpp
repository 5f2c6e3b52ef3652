// Tests the procedural samples: their sizes, orientation, closed surfaces, self-intersections and
// determinism.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "meshes.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

using testing::volume;

std::uint64_t total_triangles(const std::vector<SamplePart>& parts) {
  std::uint64_t count = 0;
  for (const SamplePart& part : parts) count += part.mesh.triangles.size();
  return count;
}

bool claims_closed(const std::string& sample, const SamplePart& part) {
  const bool sheets =
      sample == "coplanar-stack" || sample == "hair" || sample == "smoke" || sample == "greenhouse";
  return !sheets && part.name.find("label") == std::string::npos;
}

// Returns the crossings of a line with a mesh: the parameter along the line, and +1 where the line leaves the
// mesh through the back of a face.
std::vector<std::pair<double, int>> crossings(const Mesh& mesh, const Vec3d& origin, const Vec3d& direction) {
  std::vector<std::pair<double, int>> result;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t[0]]) - origin;
    const Vec3d b = to_double(mesh.positions[t[1]]) - origin;
    const Vec3d c = to_double(mesh.positions[t[2]]) - origin;
    const double u = dot(direction, cross(b, c));
    const double v = dot(direction, cross(c, a));
    const double w = dot(direction, cross(a, b));
    const bool leaves = u > 0 && v > 0 && w > 0;
    const bool enters = u < 0 && v < 0 && w < 0;
    if (!leaves && !enters) continue;
    const Vec3d normal = cross(b - a, c - a);
    result.emplace_back(dot(normal, a) / dot(normal, direction), leaves ? 1 : -1);
  }
  std::sort(result.begin(), result.end());
  return result;
}

class EverySample : public ::testing::TestWithParam<std::string> {};

TEST_P(EverySample, HasItsDocumentedSize) {
  const std::uint64_t count = total_triangles(make_sample(GetParam()));
  if (GetParam() == "coplanar-stack") {
    EXPECT_LE(count, 1000U);
  } else {
    EXPECT_GE(count, 5000U);
    EXPECT_LE(count, 20000U);
  }
  const double ratio =
      static_cast<double>(total_triangles(make_sample(GetParam(), 4.0))) / static_cast<double>(count);
  EXPECT_GT(ratio, 3.0);
  EXPECT_LT(ratio, 5.0);
}

TEST_P(EverySample, IsValidTranslucentAndHasUnitNormals) {
  for (const double detail : {0.01, 0.3, 1.0, 2.0}) {
    for (const SamplePart& part : make_sample(GetParam(), detail)) {
      const MeshReport report = check(part.mesh);
      EXPECT_EQ(report.out_of_range + report.non_finite + report.degenerate, 0U)
          << part.name << " " << detail;
      EXPECT_EQ(report.unreferenced_vertices, 0U) << part.name;
      if (GetParam() != "coplanar-stack") {
        EXPECT_EQ(report.duplicate + report.non_manifold_edges, 0U) << part.name;
      }
      EXPECT_GT(part.base_color[3], 0.0F);
      EXPECT_LT(part.base_color[3], 1.0F);
      ASSERT_EQ(part.mesh.normals.size(), part.mesh.positions.size());
      for (const Vec3f& n : part.mesh.normals) EXPECT_NEAR(length(to_double(n)), 1.0, 1e-5) << part.name;
    }
  }
}

TEST_P(EverySample, ClosedPartsFaceOutwards) {
  for (const SamplePart& part : make_sample(GetParam())) {
    if (!claims_closed(GetParam(), part)) continue;
    EXPECT_TRUE(check(part.mesh).closed()) << part.name;
    EXPECT_GT(volume(part.mesh), 0.0) << part.name;
  }
}

// Entering and leaving alternate along any line through a closed surface that does not intersect itself.
TEST_P(EverySample, ClosedPartsDoNotIntersectThemselves) {
  for (const SamplePart& part : make_sample(GetParam())) {
    if (!claims_closed(GetParam(), part)) continue;
    const BoundingSphere sphere = bounding_sphere(part.mesh);
    Random random(17);
    std::size_t hits = 0;
    for (int line = 0; line < 150; ++line) {
      const Vec3d origin = sphere.center + random.direction() * (sphere.radius * random.uniform());
      const auto found = crossings(part.mesh, origin, random.direction());
      for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].second, i % 2 == 0 ? -1 : 1) << part.name << " line " << line;
      }
      ASSERT_EQ(found.size() % 2, 0U) << part.name << " line " << line;
      hits += found.size();
    }
    EXPECT_GT(hits, 100U) << part.name;
  }
}

TEST_P(EverySample, IsTheSameEveryTime) {
  const auto first = make_sample(GetParam());
  const auto second = make_sample(GetParam());
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].name, second[i].name);
    EXPECT_EQ(first[i].mesh.positions, second[i].mesh.positions);
    EXPECT_EQ(first[i].mesh.triangles, second[i].mesh.triangles);
  }
}

std::vector<std::string> sample_names() {
  std::vector<std::string> names;
  for (const SampleInfo& info : sample_list()) names.push_back(info.name);
  return names;
}
std::string test_name(const ::testing::TestParamInfo<std::string>& sample) {
  std::string name = sample.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Samples, EverySample, ::testing::ValuesIn(sample_names()), test_name);

TEST(Samples, AreTheDocumentedOnes) {
  EXPECT_THAT(sample_names(),
              ::testing::ElementsAre("goblet", "torus-knot", "nested-shells", "coplanar-stack", "bottles",
                                     "hair", "smoke", "shelf", "greenhouse"));
}

TEST(Samples, GobletHasAWallWithTwoSides) {
  const Mesh goblet = make_sample("goblet").front().mesh;
  // A horizontal line through the bowl passes the outside, the wall, the hollow, the wall and the outside.
  const auto found = crossings(goblet, {0.01, 1.5, 0.02}, normalized(Vec3d{1, 0.001, 0.3}));
  ASSERT_EQ(found.size(), 4U);
  EXPECT_LT(found[1].first - found[0].first, 0.1);
  EXPECT_GT(found[2].first - found[1].first, 0.6);
}

TEST(Samples, ShellsAreNestedWithoutTouching) {
  const auto parts = make_sample("nested-shells");
  for (std::size_t i = 1; i < parts.size(); ++i) {
    double innermost = 1e9;
    double outermost = 0;
    for (const Triangle& t : parts[i - 1].mesh.triangles) {
      // No point of a triangle is nearer to the centre than its plane.
      const Vec3d p = to_double(parts[i - 1].mesh.positions[t[0]]);
      const Vec3d q = to_double(parts[i - 1].mesh.positions[t[1]]);
      const Vec3d r = to_double(parts[i - 1].mesh.positions[t[2]]);
      innermost = std::fmin(innermost, std::fabs(dot(normalized(cross(q - p, r - p)), p)));
    }
    for (const Vec3f& p : parts[i].mesh.positions) outermost = std::fmax(outermost, length(to_double(p)));
    EXPECT_LT(outermost, innermost) << i;
  }
}

TEST(Samples, LiquidStaysInsideTheGlass) {
  const auto parts = make_sample("bottles");
  std::map<std::string, const Mesh*> by_name;
  for (const SamplePart& part : parts) by_name[part.name] = &part.mesh;
  for (const std::string bottle : {"wine", "flask", "hip-flask"}) {
    const Mesh& glass = *by_name.at(bottle + "-glass");
    const Mesh& liquid = *by_name.at(bottle + "-liquid");
    Random random(23);
    for (int sample = 0; sample < 100; ++sample) {
      const Vec3d point = to_double(liquid.positions[random.below(liquid.positions.size())]);
      int inside_glass = 0;
      for (const auto& [at, sign] : crossings(glass, point, random.direction())) {
        if (at > 0) inside_glass += sign;
      }
      ASSERT_EQ(inside_glass, 0) << bottle << ": a point of the liquid lies in the glass itself";
    }
    EXPECT_GT(volume(liquid), 0.05) << bottle;
  }
}

TEST(Samples, CoplanarStackHasExactDuplicatesAndSharedPlanes) {
  const auto parts = make_sample("coplanar-stack");
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(check(parts[0].mesh).duplicate, parts[0].mesh.triangles.size() * 3 / 5);
  for (const Vec3f& p : parts[1].mesh.positions) EXPECT_EQ(p.y, 0.0F);
  std::map<float, int> heights;
  for (const Vec3f& p : parts[2].mesh.positions) ++heights[p.y];
  EXPECT_EQ(heights.size(), 8U);
}

TEST(Samples, RejectUnknownNamesAndDetailsOutOfRange) {
  try {
    make_sample("gobelet");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
    EXPECT_STREQ(error.what(),
                 "unknown sample 'gobelet'; known samples: goblet, torus-knot, nested-shells, "
                 "coplanar-stack, bottles, hair, smoke, shelf, greenhouse");
  }
  for (const double detail : {0.0, -1.0, 1e9, std::nan("")})
    EXPECT_THROW(make_sample("goblet", detail), Error);
}

}  // namespace
}  // namespace pellucid
