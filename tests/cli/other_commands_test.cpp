// Tests `pellucid` inspect, render, sample and techniques.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "command_line.h"
#include "pellucid/base.h"

namespace pellucid::testing {
namespace {

TEST(RenderCommand, DrawsEveryKindOfImage) {
  const TemporaryFolder folder;
  for (const char* order : {"exact", "buffers", "original", "centroid", "error"}) {
    for (const char* shading : {"lit", "depth"}) {
      const std::string png = folder.file("p.png");
      Arguments arguments{"render", samples().ordered, "-o", png, "--order", order, "--size", "96x64"};
      // The error image shows no surfaces.
      if (std::string(order) != "error") arguments.insert(arguments.end(), {"--shading", shading});
      const Finished done = run_pellucid(arguments);
      ASSERT_EQ(done.code, 0) << done.err;
      EXPECT_EQ(slurp(png).substr(0, 8), "\x89PNG\r\n\x1a\n") << order;
      EXPECT_NE(done.out.find("96x64"), std::string::npos);
    }
  }
}

TEST(RenderCommand, ExactImagesHaveNoWrongPixels) {
  const TemporaryFolder folder;
  const auto wrong = [&](const std::string& order) {
    const Finished done =
        run_pellucid({"render", samples().ordered, "-o", folder.file("p.png"), "--order", order, "--size",
                      "128x128", "--json", "-", "--camera", "orbit:40,25,inf"});
    return nlohmann::json::parse(done.out);
  };
  EXPECT_EQ(wrong("exact")["ipr"], 0.0);
  EXPECT_GT(wrong("exact")["covered_pixels"].get<int>(), 100);
  EXPECT_LE(wrong("buffers")["ipr"].get<double>(), wrong("original")["ipr"].get<double>());
}

TEST(RenderCommand, RefusesWhatItCannotDraw) {
  const TemporaryFolder folder;
  const std::string png = folder.file("p.png");
  EXPECT_EQ(run_pellucid({"render", samples().plain, "-o", png, "--order", "buffers"}).code, 4);
  for (const Arguments& bad :
       {Arguments{"--size", "0x5"}, Arguments{"--size", "12"}, Arguments{"--camera", "1"},
        Arguments{"--camera", "1,2,0"}, Arguments{"--camera", "inf,2,3"}, Arguments{"--technique", "magic"},
        Arguments{"--order", "random"}, Arguments{"--alpha", "2"}, Arguments{"--samples", "4"},
        Arguments{"--samples", "3"}, Arguments{"--cull"}}) {
    Arguments arguments{"render", samples().plain, "-o", png};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 2) << bad[0] << " " << bad.back() << ": " << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  }
  EXPECT_TRUE(folder.files().empty());
}

// Through the reference, which needs no device.
TEST(RenderCommand, EveryEffectIsDrawn) {
  const TemporaryFolder folder;
  for (const char* effect :
       {"transparency", "wireframe", "csg", "self-collision", "coplanarity", "complexity", "thickness"}) {
    const std::string png = folder.file(std::string(effect) + ".png");
    const Finished done = run_pellucid({"render", samples().plain, "-o", png, "--effect", effect,
                                        "--surfaces", "file", "--size", "64x64", "--json", "-"});
    ASSERT_EQ(done.code, 0) << done.err;
    const nlohmann::json json = nlohmann::json::parse(done.out);
    EXPECT_EQ(json["effect"], effect);
    EXPECT_EQ(json["r_h"], 1.0);
    EXPECT_TRUE(std::filesystem::exists(png));
  }
}

// A square before a camera, which leaves the view within a second.
constexpr const char* kMovingSquare =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0},{"camera":0,"translation":[0,0,3]}],
    "cameras":[{"name":"front","type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0.1,"zfar":9}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-0.5,-0.5,0],"max":[0.5,0.5,0]},
    {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},
    {"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
    {"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},
    {"buffer":0,"byteOffset":60,"byteLength":8},{"buffer":0,"byteOffset":68,"byteLength":24}],
    "buffers":[{"byteLength":92,"uri":"data:;base64,)"
    R"(AAAAvwAAAL8AAAAAAAAAPwAAAL8AAAAAAAAAPwAAAD8AAAAAAAAAvwAAAD8AAA)"
    R"(AAAAABAAIAAAACAAMAAAAAAAAAgD8AAAAAAAAAAAAAAAAAACBBAAAAAAAAAAA="}],
    "animations":[{"name":"away","samplers":[{"input":2,"output":3}],
    "channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]})";

TEST(RenderCommand, PosesAndCamerasAreThoseOfTheFile) {
  const TemporaryFolder folder;
  write_file_atomically(folder.file("square.gltf"), std::string_view(kMovingSquare));
  const auto pixels = [&](const Arguments& more) {
    Arguments arguments{"render",     folder.file("square.gltf"),
                        "-o",         folder.file("p.png"),
                        "--surfaces", "file",
                        "--effect",   "complexity",
                        "--size",     "40x40",
                        "--json",     "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out)["covered_pixels"].get<int>();
  };
  // Half the height of an image of 40 rows.
  EXPECT_EQ(pixels({"--camera", "file:front"}), 400);
  EXPECT_EQ(pixels({"--camera", "file:0", "--animation", "away"}), 400);
  // A tenth of a second moves it by one unit, ten pixels of which are still to be seen.
  EXPECT_EQ(pixels({"--camera", "file:0", "--animation", "0", "--time", "0.1"}), 200);
  EXPECT_EQ(pixels({"--camera", "file:0", "--animation", "away", "--time", "1"}), 0);
  for (const Arguments& bad :
       {Arguments{"--camera", "file:back"}, Arguments{"--camera", "file:1"}, Arguments{"--animation", "home"},
        Arguments{"--time", "1"}, Arguments{"--animation", "away", "--time", "nan"}}) {
    Arguments arguments{"render", folder.file("square.gltf"), "-o", folder.file("none.png")};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("none.png")));
  }
}

TEST(RenderCommand, OrbitsFromTheCameraOn) {
  const TemporaryFolder folder;
  const auto drawn = [&](const Arguments& more) {
    Arguments arguments{"render", samples().plain, "-o", folder.file("p.png"), "--surfaces", "file", "--size",
                        "64x48",  "--json",        "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  };
  drawn({"--camera", "200,10,2"});
  const nlohmann::json turn = drawn({"--camera", "110,10,2", "--orbit", "4"});
  ASSERT_EQ(turn["pictures"].size(), 4U);
  EXPECT_EQ(turn["pictures"][1]["output"], folder.file("p-002.png"));
  EXPECT_EQ(slurp(folder.file("p-002.png")), slurp(folder.file("p.png")));
  EXPECT_NE(slurp(folder.file("p-003.png")), slurp(folder.file("p.png")));

  std::ofstream(folder.file("path.txt")) << "# a path\n200,10,2  # here\n\n\t20,10,2\r\n";
  const nlohmann::json path = drawn({"--path", folder.file("path.txt")});
  ASSERT_EQ(path["pictures"].size(), 2U);
  EXPECT_EQ(path["pictures"][0]["fragments"], turn["pictures"][1]["fragments"]);
  EXPECT_EQ(slurp(folder.file("p-001.png")), slurp(folder.file("p.png")));
  EXPECT_EQ(path["pictures"][1]["camera"], "20,10,2");
}

TEST(RenderCommand, RefusesPathsThatAreNone) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text, const std::string& why, int code) {
    std::ofstream(folder.file("path.txt")) << text;
    const Finished done = run_pellucid({"render", samples().plain, "-o", folder.file("p.png"), "--path",
                                        folder.file("path.txt"), "--size", "16x16"});
    EXPECT_EQ(done.code, code) << text;
    EXPECT_NE(done.err.find(why), std::string::npos) << done.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("p-001.png")));
  };
  refused("30,20,3\n30\n", "path.txt:2: '30' is no camera", 3);
  refused("# nothing\n", "path.txt: there are no cameras in it", 3);
  refused("30,20,3 0.5\n", "path.txt: has times, which are those of --animation", 2);
  refused("30,20,nan 1\n", "path.txt:1", 3);
}

#if defined(PELLUCID_WITH_RENDERER)
TEST(RenderCommand, DeviceAndReferenceSeeTheSameFragments) {
  const TemporaryFolder folder;
  const auto drawn = [&](const char* technique) {
    const Finished done = run_pellucid({"render", samples().plain, "-o", folder.file("p.png"), "--technique",
                                        technique, "--surfaces", "file", "--size", "96x64", "--json", "-"});
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  };
  const nlohmann::json cpu = drawn("cpu");
  const nlohmann::json device = drawn("sb");
  EXPECT_EQ(device["captured"], device["fragments"]);
  EXPECT_NEAR(device["fragments"].get<double>(), cpu["fragments"].get<double>(),
              0.002 * cpu["fragments"].get<double>());
}

TEST(RenderCommand, CullsAndMultisamples) {
  const TemporaryFolder folder;
  const auto drawn = [&](const Arguments& more) {
    Arguments arguments{"render", samples().plain, "-o",     folder.file("p.png"),
                        "--size", "96x64",         "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  };
  const nlohmann::json all = drawn({"--technique", "f2b-2p"});
  const nlohmann::json culled = drawn({"--technique", "f2b-2p", "--cull"});
  EXPECT_EQ(all["captured"], culled["captured"]);
  EXPECT_EQ(all["drawn_share"], 1.0);
  EXPECT_LE(culled["drawn_share"].get<double>(), 1.0);
  const nlohmann::json sampled = drawn({"--technique", "f2b-2p", "--samples", "4"});
  EXPECT_NEAR(sampled["fragments"].get<double>(), 4 * all["fragments"].get<double>(),
              0.2 * all["fragments"].get<double>());
}

// What is drawn first stays: in the file's order that is what is in front.
TEST(RenderCommand, OrdersOfTheFileAreTheDrawOrder) {
  const TemporaryFolder folder;
  const auto drawn = [&](const std::string& technique, const std::string& option) {
    Arguments arguments{
        "render", samples().ordered, "-o",   folder.file("p.png"), "--technique", technique, "--k",
        "1",      "--size",          "96x64"};
    if (technique == "fab") arguments.push_back("--plain-resolve");
    if (!option.empty()) arguments.push_back(option);
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return slurp(folder.file("p.png"));
  };
  EXPECT_NE(drawn("fab", ""), drawn("fab", "--ignore-orders"));
  EXPECT_EQ(drawn("kb", ""), drawn("kb", "--ignore-orders"));
}

// In-depth orders leave little to repair; the image is exact with them and without.
TEST(RenderCommand, VerifiedBlendingRepairsLittleWhereThereAreOrders) {
  const TemporaryFolder folder;
  const auto drawn = [&](const std::string& technique, const std::string& option) {
    const std::string png = folder.file("p.png");
    Arguments arguments{"render", samples().ordered, "-o",       png,       "--technique", technique,
                        "--size", "160x120",         "--camera", "30,20,3", "--json",      "-"};
    if (!option.empty()) arguments.push_back(option);
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return std::pair(nlohmann::json::parse(done.out), slurp(png));
  };
  const auto [exact, exact_image] = drawn("sb", "");
  const auto [ordered, ordered_image] = drawn("verified", "");
  const auto [stored, stored_image] = drawn("verified", "--ignore-orders");
  EXPECT_EQ(ordered_image, exact_image);
  EXPECT_EQ(stored_image, exact_image);
  EXPECT_LT(10 * ordered["repaired_pixels"].get<int>(), stored["repaired_pixels"].get<int>());
  EXPECT_LT(ordered["bytes"].get<int>(), stored["bytes"].get<int>());
}
#endif

TEST(SampleCommand, EveryListedSampleCanBeMade) {
  const TemporaryFolder folder;
  const Finished list = run_pellucid({"sample", "--list", "--json", "-"});
  const nlohmann::json json = nlohmann::json::parse(list.out);
  EXPECT_GE(json["samples"].size(), 5U);
  for (const auto& sample : json["samples"]) {
    const std::string name = sample["name"];
    const std::string out = folder.file(name + ".glb");
    EXPECT_EQ(run_pellucid({"sample", name, "-o", out, "--detail", "0.2"}).code, 0) << name;
    EXPECT_EQ(run_pellucid({"inspect", out}).code, 0) << name;
  }
}

TEST(SampleCommand, NamesTheKnownSamplesForAnUnknownOne) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid({"sample", "teacup", "-o", folder.file("t.glb")});
  EXPECT_EQ(done.code, 2);
  EXPECT_NE(done.err.find("goblet"), std::string::npos) << done.err;
  EXPECT_EQ(run_pellucid({"sample"}).code, 2);
  EXPECT_EQ(run_pellucid({"sample", "goblet"}).code, 2);
}

TEST(TechniquesCommand, ListsWhatIsThere) {
  const nlohmann::json json = nlohmann::json::parse(run_pellucid({"techniques", "--json", "-"}).out);
  ASSERT_GE(json["techniques"].size(), 1U);
  const nlohmann::json& cpu = json["techniques"][0];
  for (const char* key : {"name", "paper", "exact", "available", "missing", "passes_formula", "bytes_formula",
                          "sync", "msaa"}) {
    EXPECT_TRUE(cpu.contains(key)) << key;
  }
  EXPECT_EQ(cpu["name"], "cpu");
}

#if defined(PELLUCID_WITH_RENDERER)
TEST(TechniquesCommand, NamesADeviceThatIsNotThere) {
  const Finished done = run_pellucid({"techniques", "--device", "no such device"});
  EXPECT_EQ(done.code, 2);
  EXPECT_NE(done.err.find("no such device"), std::string::npos);
  EXPECT_EQ(count_lines(done.err), 1U);
}
#endif

TEST(InspectCommand, PrintsTheContentsOfAFile) {
  const Finished plain = run_pellucid({"inspect", samples().plain});
  EXPECT_EQ(plain.code, 0);
  EXPECT_NE(plain.out.find("BLEND"), std::string::npos);
  EXPECT_EQ(plain.out.find("orders over"), std::string::npos);
  EXPECT_NE(run_pellucid({"inspect", samples().ordered}).out.find("2 orders over S0,1"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::testing
