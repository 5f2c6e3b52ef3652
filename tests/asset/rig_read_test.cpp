// Tests reading of animations: every legal form of joints, morph targets and key frames is read, and all
// other files are refused with a clear message.
#include "pellucid/animation.h"
#include "rigs.h"

namespace pellucid::test {
namespace {

Rig rig_of(HandMade file) {
  const TempFolder folder;
  return read_rig(read_model(file.save(folder / "rig.glb")));
}

TEST(RigNodes, TransformsParentsAndSkins) {
  HandMade file = ribbon();
  file.json["nodes"][1]["rotation"] = {0, 0, 1, 0};
  file.json["nodes"][1]["scale"] = {2, 3, 4};
  file.json["nodes"][2].erase("translation");
  file.json["nodes"][2]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1};
  const Rig rig = rig_of(file);
  ASSERT_EQ(rig.nodes.size(), 3U);
  EXPECT_EQ(rig.nodes[0].name, "body");
  EXPECT_EQ(rig.nodes[0].skin, 0U);
  EXPECT_EQ(rig.nodes[0].parent, std::nullopt);
  EXPECT_EQ(rig.nodes[0].rest.translation, (Vec3d{9, 9, 9}));
  EXPECT_EQ(rig.nodes[1].rest.rotation, (std::array<double, 4>{0, 0, 1, 0}));
  EXPECT_EQ(rig.nodes[1].rest.scale, (Vec3d{2, 3, 4}));
  EXPECT_EQ(rig.nodes[2].parent, 1U);
  ASSERT_TRUE(rig.nodes[2].rest.matrix);
  EXPECT_EQ(rig.nodes[2].rest.matrix->m[13], 8);
  EXPECT_EQ(rig.instance_nodes, (std::vector<std::uint32_t>{0}));
}

TEST(RigSkins, InverseBindMatricesAreOptional) {
  HandMade file = ribbon();
  Rig rig = rig_of(file);
  ASSERT_EQ(rig.skins.size(), 1U);
  EXPECT_EQ(rig.skins[0].joints, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(rig.skins[0].inverse_bind.at(1).m[13], -1);
  file.json["skins"][0].erase("inverseBindMatrices");
  rig = rig_of(file);
  EXPECT_EQ(rig.skins[0].inverse_bind, (std::vector<Mat4>(2)));
}

// ----------------------------------------------------------------------------------------------- joints

TEST(RigJoints, HeaviestFirstOfFloatsBytesAndShorts) {
  HandMade file = ribbon();
  Json& attributes = file.primitive()["attributes"];
  const VertexJoints expected{{1, 0}, {0.75F, 0.25F}};
  EXPECT_EQ(rig_of(file).primitives.at(0).joints.at(2), expected);

  std::vector<std::uint8_t> bytes(24, 0);
  std::vector<std::uint16_t> shorts(24, 0);
  for (std::size_t v = 0; v < 6; ++v) {
    bytes[4 * v] = 51;
    shorts[4 * v] = 51;
    bytes[4 * v + 1] = 204;
    shorts[4 * v + 1] = 204;
  }
  for (const int component : {5121, 5123}) {
    attributes["WEIGHTS_0"] =
        component == 5121 ? add_vec4(file, bytes, component) : add_vec4(file, shorts, component);
    file.json["accessors"][attributes["WEIGHTS_0"].get<std::size_t>()]["normalized"] = true;
    const std::vector<VertexJoints> joints = rig_of(file).primitives.at(0).joints;
    EXPECT_EQ(joints.at(2).joints[0], 1);
    EXPECT_NEAR(joints.at(2).weights[0], 0.8, 1e-6);
    EXPECT_NEAR(joints.at(2).weights[1], 0.2, 1e-6);
  }
  attributes["JOINTS_0"] = add_vec4(file, std::vector<std::uint16_t>(24, 1), 5123);
  EXPECT_EQ(rig_of(file).primitives.at(0).joints.at(5).joints[1], 1);
}

TEST(RigJoints, WeightsAreMadeToSumToOne) {
  HandMade file = ribbon();
  std::vector<float> weights(24, 0.0F);
  weights[0] = 0.5F;  // vertex 0: sum 2
  weights[3] = 1.5F;
  weights[4] = 3e38F;  // vertex 1: its sum is no float
  weights[5] = 3e38F;
  file.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(file, weights, 5126);
  const std::vector<VertexJoints> joints = rig_of(file).primitives.at(0).joints;
  EXPECT_EQ(joints.at(0).weights, (std::array<float, 8>{0.75F, 0.25F}));
  EXPECT_EQ(joints.at(1).weights, (std::array<float, 8>{0.5F, 0.5F}));
  EXPECT_EQ(joints.at(5), (VertexJoints{{0}, {1}})) << "without weights: joint 0";
}

TEST(RigJoints, TwoSetsAreEightJoints) {
  HandMade file = ribbon();
  Json& attributes = file.primitive()["attributes"];
  std::vector<std::uint8_t> first, second;
  for (int v = 0; v < 6; ++v) {
    first.insert(first.end(), {0, 1, 2, 3});
    second.insert(second.end(), {4, 5, 6, 7});
  }
  std::vector<float> light, heavy;
  for (int v = 0; v < 6; ++v) {
    light.insert(light.end(), {0.01F, 0.02F, 0.03F, 0.04F});
    heavy.insert(heavy.end(), {0.2F, 0.21F, 0.22F, 0.27F});
  }
  attributes["JOINTS_0"] = add_vec4(file, first, 5121);
  attributes["WEIGHTS_0"] = add_vec4(file, light, 5126);
  attributes["JOINTS_1"] = add_vec4(file, second, 5121);
  attributes["WEIGHTS_1"] = add_vec4(file, heavy, 5126);
  file.json["skins"][0] = {{"joints", {1, 2, 1, 2, 1, 2, 1, 2}}};
  const VertexJoints vertex = rig_of(file).primitives.at(0).joints.at(3);
  EXPECT_EQ(vertex.joints, (std::array<std::uint16_t, 8>{7, 6, 5, 4, 3, 2, 1, 0}));
  EXPECT_NEAR(vertex.weights[0], 0.27, 1e-6);
  EXPECT_NEAR(vertex.weights[7], 0.01, 1e-6);
}

TEST(RigJoints, JointsWithoutWeightMayBeAnything) {
  HandMade file = ribbon();
  std::vector<std::uint8_t> joints(24, 200);
  for (std::size_t v = 0; v < 6; ++v) joints[4 * v] = 1;
  file.primitive()["attributes"]["JOINTS_0"] = add_vec4(file, joints, 5121);
  std::vector<float> weights(24, 0.0F);
  for (std::size_t v = 0; v < 6; ++v) weights[4 * v] = 1;
  file.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(file, weights, 5126);
  EXPECT_EQ(rig_of(file).primitives.at(0).joints.at(0), (VertexJoints{{1}, {1}}));
}

// ---------------------------------------------------------------------------------------- morph targets

TEST(RigTargets, SparseQuantisedAndMissingPositions) {
  HandMade file = ribbon();
  Json sparse;
  sparse["count"] = 1;
  sparse["indices"] = {{"bufferView", file.view(std::vector<std::uint8_t>{4})}, {"componentType", 5121}};
  sparse["values"] = {{"bufferView", file.view(std::vector<float>{1, 2, 3})}};
  file.json["accessors"].push_back(
      {{"componentType", 5126}, {"count", 6}, {"type", "VEC3"}, {"sparse", sparse}});
  file.primitive()["targets"].push_back({{"POSITION", file.json["accessors"].size() - 1}});
  std::vector<std::int16_t> shorts(24, 0);
  shorts[4] = -32767;
  const std::size_t view = file.view(shorts);
  file.json["bufferViews"][view]["byteStride"] = 8;
  const std::size_t quantised = file.accessor(view, 5122, 6, "VEC3");
  file.json["accessors"][quantised]["normalized"] = true;
  file.primitive()["targets"].push_back({{"POSITION", quantised}});
  file.primitive()["targets"].push_back({{"NORMAL", 0}});
  const Rig rig = rig_of(file);
  const auto& targets = rig.primitives.at(0).targets;
  ASSERT_EQ(targets.size(), 3U);
  EXPECT_EQ(targets[0].at(3), (Vec3f{0, 0, 0}));
  EXPECT_EQ(targets[0].at(4), (Vec3f{1, 2, 3}));
  EXPECT_EQ(targets[1].at(1), (Vec3f{-1, 0, 0}));
  EXPECT_TRUE(targets[2].empty());
  EXPECT_EQ(rig.nodes[0].weights, (std::vector<double>{0, 0, 0}));
}

TEST(RigTargets, WeightsOfTheNodeComeBeforeTheMeshs) {
  HandMade file = ribbon();
  add_target(file, std::vector<float>(18, 1.0F));
  file.json["meshes"][0]["weights"] = {0.25};
  EXPECT_EQ(rig_of(file).nodes[0].weights, (std::vector<double>{0.25}));
  file.json["nodes"][0]["weights"] = {0.75};
  EXPECT_EQ(rig_of(file).nodes[0].weights, (std::vector<double>{0.75}));
}

// ------------------------------------------------------------------------------------------- animations

TEST(RigAnimations, ChannelsAndCurves) {
  HandMade file = ribbon();
  add_target(file, std::vector<float>(18, 1.0F));
  add_target(file, std::vector<float>(18, 2.0F));
  add_channel(file, 0, 2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  add_channel(file, 0, 1, "translation", {0.5F}, {1, 1, 1, 2, 2, 2, 3, 3, 3}, "CUBICSPLINE");
  add_channel(file, 1, 0, "weights", {0, 2}, {0, 1, 2, 3}, "STEP");
  const Rig rig = rig_of(file);
  ASSERT_EQ(rig.animations.size(), 2U);
  EXPECT_EQ(rig.animations[0].name, "clip 0");
  ASSERT_EQ(rig.animations[0].channels.size(), 2U);
  const AnimationChannel& move = rig.animations[0].channels[1];
  EXPECT_EQ(move.node, 1U);
  EXPECT_EQ(move.path, AnimatedPath::translation);
  const AnimationCurve& cubic = rig.curves.at(move.curve);
  EXPECT_EQ(cubic.interpolation, Interpolation::cubic_spline);
  EXPECT_EQ(cubic.times, (std::vector<float>{0.5F}));
  EXPECT_EQ(cubic.values.size(), 9U);
  const AnimationCurve& weights = rig.curves.at(rig.animations[1].channels.at(0).curve);
  EXPECT_EQ(weights.width, 2U);
  EXPECT_EQ(weights.interpolation, Interpolation::step);
}

TEST(RigAnimations, NormalisedIntegersAndSharedSamplers) {
  HandMade file = ribbon();
  add_channel(file, 0, 2, "rotation", {0}, {0, 0, 0, 1});
  const std::size_t output = add_vec4(file, std::vector<std::int16_t>{0, 0, 32767, -32768}, 5122);
  file.json["accessors"][output]["normalized"] = true;
  file.json["animations"][0]["samplers"][0]["output"] = output;
  file.json["animations"][0]["channels"].push_back(
      {{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}});
  const Rig rig = rig_of(file);
  ASSERT_EQ(rig.curves.size(), 1U);
  EXPECT_EQ(rig.curves[0].values, (std::vector<float>{0, 0, 1, -1}));
  EXPECT_EQ(rig.animations.at(0).channels.at(1).curve, 0U);
}

TEST(RigAnimations, ChannelsWithoutNodeOrOfUnknownPathAreLeftOut) {
  HandMade file = ribbon();
  add_channel(file, 0, 2, "translation", {0}, {0, 0, 0});
  Json& channels = file.json["animations"][0]["channels"];
  channels.push_back({{"sampler", 99}, {"target", {{"path", "pointer"}}}});
  channels.push_back({{"sampler", 99}, {"target", {{"path", "rotation"}}}});
  channels.push_back({{"sampler", 99}, {"target", {{"node", 0}, {"path", "weights"}}}});
  EXPECT_EQ(rig_of(file).animations.at(0).channels.size(), 1U);
}

TEST(RigAnimations, OtherFormatsHaveNone) {
  const Rig rig = read_rig(make_model(make_sample("bottles", 0.1), "sample"));
  EXPECT_TRUE(rig.animations.empty());
  EXPECT_TRUE(rig.nodes.empty());
  EXPECT_FALSE(rig.primitives.empty());
}

TEST(RigPrimitives, RefusesPrimitivesThatWereSplit) {
  const TempFolder folder;
  Model model = read_model(ribbon().save(folder / "rig.glb"));
  model.primitives[0].new_vertices.emplace();
  EXPECT_THAT(error_of([&] { read_rig(model); }, ErrorKind::bad_argument), ::testing::HasSubstr("split"));
}

// -------------------------------------------------------------------------------------------- bad input

struct BadRig {
  const char* name;
  std::function<void(HandMade&)> damage;
  const char* message;
};

class BadRigs : public ::testing::TestWithParam<BadRig> {};

// A ribbon with a morph target and a channel of each kind.
HandMade animated_ribbon() {
  HandMade file = ribbon();
  add_target(file, std::vector<float>(18, 1.0F));
  add_channel(file, 0, 2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  add_channel(file, 0, 1, "translation", {0, 1}, std::vector<float>(18, 1.0F), "CUBICSPLINE");
  add_channel(file, 0, 0, "weights", {0, 1}, {0, 1});
  return file;
}

TEST_P(BadRigs, AreRefusedWithTheirReason) {
  const TempFolder folder;
  HandMade file = animated_ribbon();
  EXPECT_NO_THROW(rig_of(file));
  GetParam().damage(file);
  const std::string path = file.save(folder / "bad.glb");
  const std::string message = error_of([&] { read_rig(read_model(path)); });
  EXPECT_THAT(message, ::testing::StartsWith(path + ": "));
  EXPECT_THAT(message, ::testing::HasSubstr(GetParam().message));
}

Json& sampler(HandMade& file, std::size_t index) {
  return file.json["animations"][0]["samplers"][index];
}

void set_times(HandMade& file, const std::vector<float>& times) {
  sampler(file, 0)["input"] = file.accessor(file.view(times), 5126, times.size(), "SCALAR");
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    All, BadRigs,
    ::testing::Values(
        BadRig{"MissingSkin", [](HandMade& f) { f.json["nodes"][0]["skin"] = 3; }, "skin 3 does not exist"},
        BadRig{"NoJoints", [](HandMade& f) { f.json["skins"][0]["joints"] = Json::array(); }, "no joints"},
        BadRig{"JointOutOfRange",
               [](HandMade& f) {
                 f.json["skins"][0]["joints"] = {1, 77};
               },
               "skins[0]: joint 77 does not exist"},
        BadRig{"JointBeyondTheSkin", [](HandMade& f) { f.json["skins"][0]["joints"] = {1}; },
               "follows joint 1, but skins[0] has 1 joints"},
        BadRig{"TooFewMatrices",
               [](HandMade& f) {
                 f.json["skins"][0]["joints"] = {1, 2, 1};
               },
               "2 inverse bind matrices for 3 joints"},
        BadRig{"InfiniteMatrix",
               [](HandMade& f) {
                 std::vector<float> numbers(32, 0.0F);
                 numbers[20] = kInfinite;
                 f.json["skins"][0]["inverseBindMatrices"] = f.accessor(f.view(numbers), 5126, 2, "MAT4");
               },
               "matrix 1 is not finite"},
        BadRig{"MatricesOfOtherType",
               [](HandMade& f) {
                 f.json["skins"][0]["inverseBindMatrices"] =
                     f.accessor(f.view(std::vector<float>(8)), 5126, 2, "VEC4");
               },
               "not MAT4"},
        BadRig{"CountOfJoints",
               [](HandMade& f) {
                 f.primitive()["attributes"]["JOINTS_0"] = add_vec4(f, std::vector<std::uint8_t>(20), 5121);
               },
               "it has 5 joints for 6 positions"},
        BadRig{"CountOfWeights",
               [](HandMade& f) {
                 f.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(f, std::vector<float>(28), 5126);
               },
               "it has 7 weights for 6 positions"},
        BadRig{"WeightsMissing", [](HandMade& f) { f.primitive()["attributes"].erase("WEIGHTS_0"); },
               "WEIGHTS_0 is missing"},
        BadRig{"FloatJoints",
               [](HandMade& f) {
                 f.primitive()["attributes"]["JOINTS_0"] = add_vec4(f, std::vector<float>(24), 5126);
               },
               "joints are not four unsigned"},
        BadRig{"PlainIntegerWeights",
               [](HandMade& f) {
                 f.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(f, std::vector<std::uint8_t>(24), 5121);
               },
               "neither floats nor normalised"},
        BadRig{"NegativeWeight",
               [](HandMade& f) {
                 f.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(f, std::vector<float>(24, -1.0F), 5126);
               },
               "vertex 0 is negative or not finite"},
        BadRig{"NotANumberWeight",
               [](HandMade& f) {
                 f.primitive()["attributes"]["WEIGHTS_0"] = add_vec4(f, std::vector<float>(24, kNan), 5126);
               },
               "vertex 0 is negative or not finite"},
        BadRig{"CountOfTarget",
               [](HandMade& f) {
                 f.primitive()["targets"][0]["POSITION"] =
                     f.accessor(f.view(std::vector<float>(15)), 5126, 5, "VEC3");
               },
               "targets[0]: it has 5 positions for 6 positions"},
        BadRig{"InfiniteTarget",
               [](HandMade& f) {
                 f.primitive()["targets"][0]["POSITION"] =
                     f.accessor(f.view(std::vector<float>(18, kInfinite)), 5126, 6, "VEC3");
               },
               "element 0 is not finite"},
        BadRig{"CountOfMorphWeights",
               [](HandMade& f) {
                 f.json["nodes"][0]["weights"] = {1, 2};
               },
               "weights does not hold 1 numbers"},
        BadRig{"UnequalTargets",
               [](HandMade& f) {
                 Json second = f.primitive();
                 second.erase("targets");
                 f.json["meshes"][0]["primitives"].push_back(second);
               },
               "different numbers of morph targets"},
        BadRig{"TimesNotIncreasing",
               [](HandMade& f) {
                 set_times(f, {0.5F, 0.5F});
               },
               "not later than"},
        BadRig{"TimesFalling",
               [](HandMade& f) {
                 set_times(f, {1, 0});
               },
               "not later than"},
        BadRig{"TimeNotANumber",
               [](HandMade& f) {
                 set_times(f, {0, kNan});
               },
               "time 1 is negative, not"},
        BadRig{"TimeInfinite",
               [](HandMade& f) {
                 set_times(f, {0, kInfinite});
               },
               "time 1 is negative, not"},
        BadRig{"TimeNegative",
               [](HandMade& f) {
                 set_times(f, {-1, 0});
               },
               "time 0 is negative"},
        BadRig{
            "NoTimes",
            [](HandMade& f) { f.json["accessors"][sampler(f, 0)["input"].get<std::size_t>()]["count"] = 0; },
            "has no key frames"},
        BadRig{"IntegerTimes",
               [](HandMade& f) {
                 sampler(f, 0)["input"] =
                     f.accessor(f.view(std::vector<std::uint16_t>{0, 1}), 5123, 2, "SCALAR");
               },
               "not floats"},
        BadRig{"CountOfOutputs",
               [](HandMade& f) {
                 set_times(f, {0, 1, 2});
               },
               "its output has 2 elements; 3 key frames need 3"},
        BadRig{"CountOfCubicOutputs", [](HandMade& f) { sampler(f, 1)["interpolation"] = "LINEAR"; },
               "its output has 6 elements; 2 key frames need 2"},
        BadRig{"AbsurdCount",
               [](HandMade& f) {
                 f.json["accessors"][sampler(f, 0)["input"].get<std::size_t>()]["count"] = 4000000000U;
               },
               "asks for 4000000000 elements"},
        BadRig{"OutputNotANumber",
               [](HandMade& f) {
                 sampler(f, 0)["output"] = add_vec4(f, std::vector<float>{0, 0, 0, 1, 0, 0, kNan, 0}, 5126);
               },
               "number 6 of it is not finite"},
        BadRig{"OutputOfOtherType",
               [](HandMade& f) { f.json["animations"][0]["channels"][0]["target"]["path"] = "scale"; },
               "type is VEC4, not VEC3"},
        BadRig{"UnknownInterpolation", [](HandMade& f) { sampler(f, 0)["interpolation"] = "SPLINE"; },
               "interpolation SPLINE does not exist"},
        BadRig{"MissingSampler", [](HandMade& f) { f.json["animations"][0]["channels"][0]["sampler"] = 9; },
               "samplers[9]"},
        BadRig{"MissingNode",
               [](HandMade& f) { f.json["animations"][0]["channels"][0]["target"]["node"] = 9; },
               "node 9 does not exist"},
        BadRig{"MissingTarget", [](HandMade& f) { f.json["animations"][0]["channels"][0].erase("target"); },
               "target is missing"},
        BadRig{"AnimatedMatrix",
               [](HandMade& f) {
                 f.json["nodes"][2]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
               },
               "cannot be animated"},
        BadRig{"Cycle", [](HandMade& f) { f.json["nodes"][2]["children"] = {1}; }, "ancestor"}),
    [](const auto& test) { return test.param.name; });

TEST(BadRigs, BytesDamagedAtRandomAreReadOrRefused) {
  const TempFolder folder;
  HandMade file = animated_ribbon();
  const std::string path = file.save(folder / "good.glb");
  const Bytes good = read_file(path);
  Random random(7);
  for (int round = 0; round < 300; ++round) {
    Bytes bad = good;
    for (std::uint64_t k = 0; k <= random.below(3); ++k) {
      bad[random.below(bad.size())] = static_cast<std::byte>(random.below(256));
    }
    write_file_atomically(folder / "bad.glb", bad);
    error_of([&] { read_rig(read_model(folder / "bad.glb")); });
  }
}

}  // namespace
}  // namespace pellucid::test
