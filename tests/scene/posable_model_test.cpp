// Tests poses of hand-made rigs against a second, independent implementation of skinning, interpolation and
// morphing.
#include <cmath>
#include <thread>

#include "meshes.h"
#include "pellucid/scene.h"
#include "pellucid/subdivide.h"
#include "rigs.h"

namespace pellucid::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

PosableModel posable(HandMade file, std::uint32_t subdivisions = 0) {
  const TempFolder folder;
  return PosableModel(read_model(file.save(folder / "rig.glb")), subdivisions);
}

std::vector<Vec3f> posed(const PosableModel& model, double time, std::uint32_t clip = 0) {
  std::vector<Vec3f> positions;
  model.pose(clip, time, positions);
  return positions;
}

void expect_near(const std::vector<Vec3f>& actual, const std::vector<Vec3d>& expected,
                 double tolerance = 1e-6) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t v = 0; v < actual.size(); ++v) {
    EXPECT_LT(length(to_double(actual[v]) - expected[v]), tolerance)
        << v << ": " << actual[v].x << " " << actual[v].y << " " << actual[v].z;
  }
}

// Rodrigues' formula, which knows nothing of quaternions.
Vec3d rotated(const Vec3d& p, const Vec3d& axis, double angle) {
  return p * std::cos(angle) + cross(axis, p) * std::sin(angle) +
         axis * (dot(axis, p) * (1 - std::cos(angle)));
}

std::vector<float> quaternion(const Vec3d& axis, double angle) {
  const Vec3f v = to_float(axis * std::sin(angle / 2));
  return {v.x, v.y, v.z, static_cast<float>(std::cos(angle / 2))};
}

std::vector<float> join(std::vector<float> a, const std::vector<float>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// One triangle at node 0.
HandMade lone_triangle() {
  HandMade file;
  file.set_positions({1, 0, 0, 0, 1, 0, 0, 0, 1});
  file.set_indices(std::vector<std::uint16_t>{0, 1, 2});
  return file;
}

// ------------------------------------------------------------------------------------------------- skins

const Vec3d kHipAxis = normalized(Vec3d{1, 2, -1});
const Vec3d kKneeAxis = normalized(Vec3d{-1, 0.5, 3});

// The ribbon's vertices where hip and knee are turned by these angles and the hip is moved.
std::vector<Vec3d> bent_ribbon(double hip, double knee, const Vec3d& moved) {
  const std::vector<Vec3d> rest{{0, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, {0.5, 1, 0}, {0, 2, 0}, {0.5, 2, 0}};
  const std::vector<double> knee_weights{0, 0, 0.75, 0.5, 1, 1};
  std::vector<Vec3d> positions;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const Vec3d above{0, 1, 0};
    const Vec3d by_hip = rotated(rest[v], kHipAxis, hip) + moved;
    const Vec3d by_knee = rotated(rotated(rest[v] - above, kKneeAxis, knee) + above, kHipAxis, hip) + moved;
    positions.push_back(by_hip * (1 - knee_weights[v]) + by_knee * knee_weights[v]);
  }
  return positions;
}

HandMade bending_ribbon() {
  HandMade file = ribbon();
  add_channel(file, 0, 1, "rotation", {0, 2}, join(quaternion(kHipAxis, 0.2), quaternion(kHipAxis, 1.4)));
  add_channel(file, 0, 2, "rotation", {0.5F, 1}, join(quaternion(kKneeAxis, 0), quaternion(kKneeAxis, 2)));
  add_channel(file, 0, 1, "translation", {0, 1}, {0, 0, 0, 4, 5, 6});
  return file;
}

TEST(PosableModel, SkinnedMeshIgnoresItsNodeAndFollowsItsJoints) {
  HandMade file = ribbon();
  const PosableModel still = posable(file);
  expect_near(still.rest_pose(), bent_ribbon(0, 0, {}));

  // At rest the joints count, too.
  file.json["nodes"][2]["rotation"] = quaternion(kKneeAxis, 0.7);
  expect_near(posable(file).rest_pose(), bent_ribbon(0, 0.7, {}));
}

TEST(PosableModel, BendsLikeSkinningWrittenDownASecondTime) {
  const PosableModel model = posable(bending_ribbon());
  for (const double time : {0.0, 0.3, 0.5, 0.77, 1.0, 1.9, 2.0}) {
    const double hip = 0.2 + 0.6 * time;
    const double knee = 4 * std::clamp(time - 0.5, 0.0, 0.5);
    expect_near(posed(model, time), bent_ribbon(hip, knee, Vec3d{4, 5, 6} * std::min(time, 1.0)), 2e-6);
  }
}

TEST(PosableModel, TimesOutsideAreClamped) {
  const PosableModel model = posable(bending_ribbon());
  EXPECT_EQ(posed(model, -3), posed(model, 0));
  EXPECT_EQ(posed(model, 1e9), posed(model, 2));
  EXPECT_EQ(posed(model, -std::numeric_limits<double>::infinity()), posed(model, 0));
}

TEST(PosableModel, EightJointsPullTogether) {
  HandMade file = ribbon();
  Json& attributes = file.primitive()["attributes"];
  std::vector<std::uint8_t> first, second;
  for (int v = 0; v < 6; ++v) {
    first.insert(first.end(), {0, 1, 2, 3});
    second.insert(second.end(), {4, 5, 6, 7});
  }
  const std::vector<float> eighths(24, 0.125F);
  attributes["JOINTS_0"] = add_vec4(file, first, 5121);
  attributes["JOINTS_1"] = add_vec4(file, second, 5121);
  attributes["WEIGHTS_0"] = attributes["WEIGHTS_1"] = add_vec4(file, eighths, 5126);
  file.json["skins"][0] = {{"joints", Json::array()}};
  Json& nodes = file.json["nodes"];
  for (int joint = 0; joint < 8; ++joint) {
    file.json["skins"][0]["joints"].push_back(nodes.size());
    file.json["scenes"][0]["nodes"].push_back(nodes.size());
    nodes.push_back({{"translation", {1 << joint, 0, 0}}});
  }
  const std::vector<Vec3f> rest = posable(file).rest_pose();
  EXPECT_NEAR(rest.at(0).x, 255.0 / 8, 1e-5);
  EXPECT_NEAR(rest.at(5).x, 0.5 + 255.0 / 8, 1e-5);
}

TEST(PosableModel, TwoInstancesOfOneMeshFollowTheirOwnSkins) {
  HandMade file = ribbon();
  file.json["nodes"].push_back({{"mesh", 0}, {"skin", 1}});
  file.json["nodes"].push_back({{"translation", {0, 0, 5}}});
  file.json["skins"].push_back({{"joints", {4, 4}}});
  file.json["scenes"][0]["nodes"] = {0, 1, 3, 4};
  const PosableModel model = posable(file);
  ASSERT_EQ(model.parts().size(), 2U);
  EXPECT_EQ(model.parts()[1].first_vertex, 6U);
  EXPECT_EQ(model.parts()[1].first_triangle, 4U);
  EXPECT_EQ(model.parts()[1].instance, 1U);
  EXPECT_EQ(model.triangles().at(4), (Triangle{6, 7, 9}));
  EXPECT_EQ(model.rest_pose().at(6), (Vec3f{0, 0, 5}));
}

// --------------------------------------------------------------------------------------------- interpolation

TEST(PosableModel, LinearStepAndCubicTranslations) {
  HandMade file = lone_triangle();
  add_channel(file, 0, 0, "translation", {1, 3}, {2, 0, 0, 6, 0, 0});
  add_channel(file, 1, 0, "translation", {1, 3}, {2, 0, 0, 6, 0, 0}, "STEP");
  // In-tangent, value, out-tangent of both keys.
  add_channel(file, 2, 0, "translation", {1, 3}, {9, 0, 0, 2, 0, 0, 1, 0, 0, -2, 0, 0, 6, 0, 0, 9, 0, 0},
              "CUBICSPLINE");
  const PosableModel model = posable(file);
  EXPECT_NEAR(posed(model, 1.5, 0).at(1).x, 3, 1e-6);
  EXPECT_EQ(posed(model, 2.999, 1).at(1).x, 2);
  EXPECT_EQ(posed(model, 3, 1).at(1).x, 6);
  // Hermite at 1/4 of 2 s: 0.84375 * 2 + 2 * 0.140625 * 1 + 0.15625 * 6 + 2 * -0.046875 * -2.
  EXPECT_NEAR(posed(model, 1.5, 2).at(1).x, 1.6875 + 0.28125 + 0.9375 + 0.1875, 1e-6);
  EXPECT_NEAR(posed(model, 1, 2).at(1).x, 2, 1e-6);
  EXPECT_NEAR(posed(model, 3, 2).at(1).x, 6, 1e-6);
}

TEST(PosableModel, RotationsTurnEvenlyAlongTheShorterWay) {
  const Vec3d axis = normalized(Vec3d{1, 1, 3});
  const std::vector<float> from = quaternion(axis, 0.1), to = quaternion(axis, 2.9);
  std::vector<float> negative = to;
  for (float& q : negative) q = -q;
  for (const std::vector<float>& end : {to, negative}) {
    HandMade file = lone_triangle();
    add_channel(file, 0, 0, "rotation", {0, 1}, join(from, end));
    const PosableModel model = posable(file);
    for (const double time : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const double angle = 0.1 + 2.8 * time;
      expect_near(posed(model, time), {rotated({1, 0, 0}, axis, angle), rotated({0, 1, 0}, axis, angle),
                                       rotated({0, 0, 1}, axis, angle)});
    }
  }
}

TEST(PosableModel, NearlyEqualRotationsStayUnit) {
  const Vec3d axis{0, 0, 1};
  HandMade file = lone_triangle();
  std::vector<float> keys = join(quaternion(axis, 1), quaternion(axis, 1.00001));
  for (float& q : keys) q *= 3;  // and of any length
  add_channel(file, 0, 0, "rotation", {0, 1}, keys);
  expect_near(posed(posable(file), 0.5),
              {rotated({1, 0, 0}, axis, 1.000005), rotated({0, 1, 0}, axis, 1.000005), {0, 0, 1}});
}

TEST(PosableModel, CubicRotationsAreMadeUnit) {
  HandMade file = lone_triangle();
  const std::vector<float> still(4, 0.0F);
  const std::vector<float> first = join(still, join(quaternion({0, 0, 1}, 0), still));
  const std::vector<float> second = join(still, join(quaternion({0, 0, 1}, kPi / 2), still));
  add_channel(file, 0, 0, "rotation", {0, 1}, join(first, second), "CUBICSPLINE");
  // Without tangents the middle is the mean of both, which bisects the angle once it is of unit length.
  expect_near(posed(posable(file), 0.5),
              {rotated({1, 0, 0}, {0, 0, 1}, kPi / 4), rotated({0, 1, 0}, {0, 0, 1}, kPi / 4), {0, 0, 1}});
}

TEST(PosableModel, ZeroQuaternionsDoNotSpoilThePose) {
  HandMade file = lone_triangle();
  add_channel(file, 0, 0, "rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0});
  expect_near(posed(posable(file), 0.5), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

// ---------------------------------------------------------------------------------------------------- morphs

TEST(PosableModel, MorphTargetsAtRestAndAnimated) {
  HandMade file = lone_triangle();
  add_target(file, {1, 0, 0, 0, 0, 0, 0, 0, 0});
  add_target(file, {0, 0, 8, 0, 0, 8, 0, 0, 8});
  file.json["meshes"][0]["weights"] = {0.5, 0.25};
  file.json["nodes"][0]["translation"] = {0, 0, 100};
  add_channel(file, 0, 0, "weights", {0, 2}, {0, 0, 1, 0.5F});
  // Cubic: all in-tangents of a key, then all values, then all out-tangents.
  add_channel(file, 1, 0, "weights", {0, 1}, {0, 0, 0, 0, 1, -1, 0, 0, 1, 1, 0, 0}, "CUBICSPLINE");
  const PosableModel model = posable(file);
  expect_near(model.rest_pose(), {{1.5, 0, 102}, {0, 1, 102}, {0, 0, 103}}, 1e-5);
  expect_near(posed(model, 1, 0), {{1.5, 0, 102}, {0, 1, 102}, {0, 0, 103}}, 1e-5);
  // Hermite at 1/2: 1/8 of the out-tangent, 1/2 of the end value.
  expect_near(posed(model, 0.5, 1), {{1.625, 0, 103}, {0, 1, 103}, {0, 0, 104}}, 1e-5);
}

TEST(PosableModel, MorphComesBeforeSkin) {
  HandMade file = bending_ribbon();
  std::vector<float> deltas(18, 0.0F);
  deltas[15] = -0.5F;  // vertex 5 to where vertex 4 is
  add_target(file, deltas);
  file.json["nodes"][0]["weights"] = {1};
  const std::vector<Vec3f> positions = posed(posable(file), 0.8);
  EXPECT_LT(length(positions.at(4) - positions.at(5)), 1e-6F);
}

// ------------------------------------------------------------------------------------- parts, clips and
// times

TEST(PosableModel, ParentsMoveTheirChildren) {
  HandMade file = lone_triangle();
  file.json["nodes"] = Json::parse(R"([{"children":[1]},{"mesh":0,"scale":[2,2,2]}])");
  add_channel(file, 0, 0, "translation", {0, 1}, {0, 0, 0, 1, 1, 1});
  add_channel(file, 0, 1, "scale", {0, 1}, {2, 2, 2, 4, 4, 4});
  expect_near(posed(posable(file), 0.5), {{3.5, 0.5, 0.5}, {0.5, 3.5, 0.5}, {0.5, 0.5, 3.5}});
}

TEST(PosableModel, MirroredPartsAreTurned) {
  HandMade file = lone_triangle();
  file.json["nodes"][0]["scale"] = {1, 1, -1};
  EXPECT_EQ(posable(file).triangles(), (std::vector<Triangle>{{0, 2, 1}}));

  HandMade skinned = ribbon();
  skinned.json["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_EQ(posable(skinned).triangles().at(0), (Triangle{0, 1, 3})) << "a skinned mesh ignores its node";
  skinned.json["nodes"][1]["scale"] = {-1, 1, 1};
  EXPECT_EQ(posable(skinned).triangles().at(0), (Triangle{0, 3, 1}));
}

TEST(PosableModel, ASceneTurnsMirroredPartsOnceHoweverOftenItIsPosed) {
  HandMade skinned = ribbon();
  skinned.json["nodes"][1]["scale"] = {-1, 1, 1};
  add_channel(skinned, 0, 2, "translation", {0, 1}, {0, 1, 0, 0, 1, 0});
  const TempFolder folder;
  const Model model = read_model(skinned.save(folder / "mirrored.glb"));
  Scene scene = make_scene(model);
  EXPECT_EQ(scene.mesh.triangles.at(0), (Triangle{0, 3, 1}));
  for (int i = 0; i < 2; ++i) {
    pose_scene(model, "0", 0.5, scene);
    EXPECT_EQ(scene.mesh.triangles.at(0), (Triangle{0, 3, 1}));
  }
}

TEST(PosableModel, DegenerateTrianglesAreKept) {
  if (!can_subdivide()) GTEST_SKIP() << "this build has no OpenSubdiv";
  HandMade file = lone_triangle();
  file.set_indices(std::vector<std::uint16_t>{0, 0, 1, 0, 1, 2});
  EXPECT_EQ(posable(file).triangles().size(), 2U);
  EXPECT_EQ(posable(file, 1).triangles().size(), 4U);
}

TEST(PosableModel, ModelsOfOtherFormatsStandStill) {
  const std::vector<SamplePart> sample = make_sample("bottles", 0.2);
  const PosableModel model(make_model(sample, "sample"));
  EXPECT_EQ(model.parts().size(), sample.size());
  EXPECT_TRUE(model.clips().empty());
  const std::vector<Vec3f> rest = model.rest_pose();
  EXPECT_EQ(rest.at(0), sample[0].mesh.positions[0]);
  EXPECT_THROW(posed(model, 0), Error);
}

TEST(PosableModel, ClipsHoldTheTimesOfWhatMovesSomething) {
  HandMade file = ribbon();
  file.json["nodes"].push_back({{"name", "lamp"}});
  file.json["scenes"][0]["nodes"].push_back(3);
  add_channel(file, 0, 3, "translation", {0, 7}, {0, 0, 0, 1, 1, 1});  // moves nothing drawn
  add_channel(file, 1, 3, "translation", {0, 7}, {0, 0, 0, 1, 1, 1});
  add_channel(file, 1, 0, "translation", {0, 8}, {0, 0, 0, 1, 1, 1});  // the skinned mesh's own node
  add_channel(file, 1, 1, "translation", {0.5F, 1}, {0, 0, 0, 1, 1, 1});
  add_channel(file, 1, 2, "scale", {0.25F, 1.000004F, 2}, {1, 1, 1, 1, 1, 1, 1, 1, 1});
  const PosableModel model = posable(file);
  ASSERT_EQ(model.clips().size(), 1U);
  EXPECT_EQ(model.clips()[0].name, "clip 1");
  EXPECT_EQ(model.clips()[0].animation, 1U);
  EXPECT_EQ(model.clips()[0].key_times, (std::vector<double>{0.25, 0.5, 1, 2}));
}

TEST(TimesAtRate, FromTheFirstToTheLast) {
  AnimationClip clip;
  clip.key_times = {1, 1.7, 2};
  EXPECT_EQ(times_at_rate(clip, 4), (std::vector<double>{1, 1.25, 1.5, 1.75, 2}));
  EXPECT_EQ(times_at_rate(clip, 1.5).size(), 3U);
  EXPECT_EQ(times_at_rate(clip, 1.5).back(), 2);
  EXPECT_EQ(times_at_rate(clip, 0.01), (std::vector<double>{1, 2}));
  clip.key_times = {3};
  EXPECT_EQ(times_at_rate(clip, 30), (std::vector<double>{3}));
  clip.key_times = {0, 1.1F};  // 33 steps and a rounding
  EXPECT_EQ(times_at_rate(clip, 30).size(), 34U);
  for (const double rate : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e9}) {
    EXPECT_THROW(times_at_rate(clip, rate), Error) << rate;
  }
}

TEST(PosableModel, ThreadsPoseAtOnce) {
  if (!can_subdivide()) GTEST_SKIP() << "this build has no OpenSubdiv";
  const PosableModel model = posable(bending_ribbon(), 2);
  std::vector<std::vector<Vec3f>> alone, together(8);
  for (std::size_t i = 0; i < together.size(); ++i)
    alone.push_back(posed(model, 0.25 * static_cast<double>(i)));
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < together.size(); ++i) {
    threads.emplace_back([&, i] { model.pose(0, 0.25 * static_cast<double>(i), together[i]); });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together, alone);
}

// -------------------------------------------------------------------------------------------- subdivision

TEST(PosableModel, RigidMotionAndSubdivisionCommute) {
  if (!can_subdivide()) GTEST_SKIP() << "this build has no OpenSubdiv";
  HandMade file;
  const Mesh sphere = testing::icosphere_mesh(1);
  std::vector<float> coordinates;
  for (const Vec3f& p : sphere.positions) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  std::vector<std::uint16_t> indices;
  for (const Triangle& t : sphere.triangles) {
    for (const std::uint32_t v : t) indices.push_back(static_cast<std::uint16_t>(v));
  }
  file.set_positions(coordinates);
  file.set_indices(indices);
  const Vec3d axis = normalized(Vec3d{3, -1, 2});
  add_channel(file, 0, 0, "rotation", {0, 1}, join(quaternion(axis, 0), quaternion(axis, 2)));
  add_channel(file, 0, 0, "translation", {0, 1}, {0, 0, 0, 5, -6, 7});

  const PosableModel coarse = posable(file), fine = posable(file, 2);
  Mesh posed_first{posed(coarse, 0.7), {}, coarse.triangles()};
  const Mesh refined = subdivide(posed_first, 2);
  EXPECT_EQ(fine.triangles(), refined.triangles);
  std::vector<Vec3d> expected;
  for (const Vec3f& p : refined.positions) expected.push_back(to_double(p));
  expect_near(posed(fine, 0.7), expected, 3e-6);
}

TEST(PosableModel, SubdividedRibbonBendsSmoothlyAndMorphs) {
  if (!can_subdivide()) GTEST_SKIP() << "this build has no OpenSubdiv";
  HandMade file = bending_ribbon();
  std::vector<float> deltas;
  for (int v = 0; v < 6; ++v) deltas.insert(deltas.end(), {0, 0, 3});
  add_target(file, deltas);
  file.json["nodes"][0]["weights"] = {1};
  const PosableModel model = posable(file, 3);
  EXPECT_EQ(model.triangles().size(), 4U * 64U);
  // Every vertex is moved by the same morph, whatever its stencil.
  for (const Vec3f& p : model.rest_pose()) EXPECT_NEAR(p.z, 3, 1e-6);
  for (const double time : {0.0, 0.6, 2.0}) {
    for (const Vec3f& p : posed(model, time)) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  }
}

TEST(PosableModel, SeamsStayClosedAndPartsThatMoveApartDoNotGrowTogether) {
  if (!can_subdivide()) GTEST_SKIP() << "this build has no OpenSubdiv";
  // Two triangles that share an edge, without common vertices.
  HandMade file;
  file.set_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  file.set_indices(std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5});
  std::vector<std::uint8_t> joints(24, 0);
  std::vector<float> weights(24, 0.0F);
  for (std::size_t v = 0; v < 6; ++v) weights[4 * v] = 1;
  const auto bind = [&] {
    file.primitive()["attributes"]["JOINTS_0"] = add_vec4(file, joints, 5121);
    file.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(file, weights, 5126);
  };
  file.json["nodes"] = Json::parse(R"([{"mesh":0,"skin":0},{},{}])");
  file.json["scenes"] = Json::parse(R"([{"nodes":[0,1,2]}])");
  file.json["skins"] = Json::parse(R"([{"joints":[1,2]}])");
  bind();
  EXPECT_EQ(posable(file, 1).rest_pose().size(), 9U);
  for (std::size_t v = 3; v < 6; ++v) joints[4 * v] = 1;
  bind();
  EXPECT_EQ(posable(file, 1).rest_pose().size(), 12U);
}

TEST(PosableModel, AbsurdSubdivisionsAreRefused) {
  EXPECT_THROW(posable(lone_triangle(), 4), Error);
  EXPECT_THROW(posable(lone_triangle(), 4000000000U), Error);
}

}  // namespace
}  // namespace pellucid::test
