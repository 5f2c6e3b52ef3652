// Tests `pellucid compare`.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "command_line.h"
#include "report/markup.h"
#include "report/schema.h"

namespace pellucid::testing {
namespace {

TEST(CompareCommand, RefusesValuesOutOfRange) {
  const TemporaryFolder folder;
  const std::string page = folder.file("r.html");
  for (const Arguments& bad :
       {Arguments{"--techniques", "magic"}, Arguments{"--techniques", ","}, Arguments{"--sweep", "time"},
        Arguments{"--size", "0x5"}, Arguments{"--camera", "1"}, Arguments{"--reference", "gpu"},
        Arguments{"--frames", "0"}, Arguments{"--flicker", "721"}, Arguments{"--device", "no such device"}}) {
    Arguments arguments{"compare", samples().plain, "-o", page};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 2) << bad[0] << " " << bad[1] << ": " << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  }
  EXPECT_EQ(run_pellucid({"compare", "-o", page}).code, 2);
  EXPECT_TRUE(folder.files().empty());
}

TEST(CompareCommand, RefusesWhereItCannotWriteBeforeAnythingIsDrawn) {
  const TemporaryFolder folder;
  spill(folder.file("file"), "");
  std::filesystem::create_directories(folder.file("taken/report.html"));
  std::filesystem::create_directories(folder.file("odd"));
  spill(folder.file("odd/images"), "");
  for (const char* output : {"no/r.html", "no/report", "file/", "file/r.html", "taken", "odd/"}) {
    const Finished done = run_pellucid({"compare", samples().plain, "-o", folder.file(output)});
    EXPECT_EQ(done.code, 1) << output << ": " << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    EXPECT_EQ(done.out, "") << output;
  }
  EXPECT_EQ(folder.files().size(), 3U);
}

#if defined(PELLUCID_WITH_RENDERER)
// Few kernels, small images: the driver compiles each of them. What validation says would be on stderr.
Arguments quick(const Arguments& more) {
  Arguments arguments{"compare", "--validation-layers", "--plain-resolve", "--size", "96x64", "--frames",
                      "2"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

nlohmann::json schema() {
  std::ifstream file(PELLUCID_SCHEMA "/compare.schema.json");
  return nlohmann::json::parse(file);
}

TEST(CompareCommand, TellsWhatTechniquesCapture) {
  const TemporaryFolder folder;
  const std::string stack = folder.file("stack.glb");
  ASSERT_EQ(run_pellucid({"sample", "coplanar-stack", "-o", stack}).code, 0);
  const std::string page = folder.file("r.html");
  const std::string file = folder.file("r.json");
  const Finished done = run_pellucid(quick({stack, samples().plain, "--techniques", "ll,f2b,cpu,ll",
                                            "--flicker", "2", "-o", page, "--json", file}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const nlohmann::json json = parse_json_file(file);
  EXPECT_EQ(first_violation(json, schema()), "");
  ASSERT_EQ(json["scenes"].size(), 2U);
  const nlohmann::json& scene = json["scenes"][0];
  ASSERT_EQ(scene["techniques"].size(), 3U);
  EXPECT_GT(scene["c_p"].get<double>(), 0.3);
  const nlohmann::json& ll = scene["techniques"][0];
  const nlohmann::json& f2b = scene["techniques"][1];
  const nlohmann::json& cpu = scene["techniques"][2];
  EXPECT_EQ(ll["r_h"], 1);
  EXPECT_EQ(ll["differing_pixels"], 0);
  EXPECT_EQ(ll["total"], scene["fragments"]);
  EXPECT_LT(f2b["r_h"].get<double>(), 0.9);
  EXPECT_LT(f2b["psnr"].get<double>(), ll["psnr"].get<double>());
  EXPECT_EQ(f2b["coplanar"], 0);
  EXPECT_EQ(scene["flicker_frames"], 2);
  EXPECT_LT(ll["flicker"].get<double>(), 0.01);
  EXPECT_GT(f2b["flicker"].get<double>(), ll["flicker"].get<double>());
  // The reference works on its own fragments, which are the same up to rounding.
  EXPECT_NEAR(cpu["total"].get<double>(), scene["fragments"].get<double>(),
              0.02 * cpu["total"].get<double>());
  EXPECT_GT(cpu["psnr"].get<double>(), 30);
  std::uint64_t fragments = 0;
  for (std::size_t n = 0; n < scene["pixels_by_depth"].size(); ++n)
    fragments += n * scene["pixels_by_depth"][n].get<std::uint64_t>();
  EXPECT_EQ(fragments, scene["fragments"].get<std::uint64_t>());

  const std::string html = slurp(page);
  EXPECT_EQ(first_nesting_error(html, "<html"), "");
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_NE(html.find("fastest exact"), std::string::npos);
  EXPECT_NE(done.out.find("C_p"), std::string::npos);
}

TEST(CompareCommand, FillsAFolder) {
  const TemporaryFolder folder;
  const std::string report = folder.file("report");
  for (int run = 0; run < 2; ++run) {  // makes the folder, then writes into it
    const Finished done = run_pellucid(
        quick({samples().plain, "--techniques", "ll,wboit", "-o", report + (run == 0 ? "" : "/")}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "");
  }
  const nlohmann::json json = parse_json_file(report + "/report.json");
  EXPECT_EQ(first_violation(json, schema()), "");
  const nlohmann::json& scene = json["scenes"][0];
  EXPECT_EQ(scene["techniques"][0]["picture"], scene["picture"]);
  EXPECT_NE(scene["techniques"][1]["picture"], scene["picture"]);
  for (const nlohmann::json& path :
       {scene["picture"], scene["techniques"][1]["picture"], scene["techniques"][1]["difference"]})
    EXPECT_EQ(slurp(report + "/" + path.get<std::string>()).substr(1, 3), "PNG") << path;
  EXPECT_NE(slurp(report + "/report.html").find("<div class=\"viewer\""), std::string::npos);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(report)) files += entry.exists() ? 1U : 0U;
  EXPECT_EQ(files, 3U);
}

TEST(CompareCommand, AnEffectThatTheSceneIsTooMuchForIsAnError) {
  const TemporaryFolder folder;
  const std::string bottles = folder.file("bottles.glb");
  ASSERT_EQ(run_pellucid({"sample", "bottles", "-o", bottles, "--detail", "0.02"}).code, 0);
  const Finished done = run_pellucid(
      quick({bottles, "--techniques", "ll", "--effect", "self-collision", "-o", folder.file("r.html")}));
  EXPECT_EQ(done.code, 2) << done.err;
  EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  EXPECT_EQ(folder.files().size(), 1U);
}

TEST(CompareCommand, SweepsAScene) {
  const Finished done = run_pellucid(quick({samples().plain, "--techniques", "ll,f2b", "--sweep",
                                            "coplanarity,depth,memory,resolution", "--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_EQ(first_violation(json, schema()), "");
  ASSERT_EQ(json["sweeps"].size(), 4U);
  const auto value = [&](std::size_t sweep, std::size_t point, std::size_t technique, const char* key) {
    return json["sweeps"][sweep]["points"][point]["techniques"][technique][key].get<double>();
  };
  // Copies in one place: of n fragments at a depth, f2b keeps one.
  const double one = value(0, 0, 1, "captured");
  EXPECT_EQ(value(0, 3, 0, "total"), 8 * value(0, 0, 0, "total"));
  EXPECT_EQ(value(0, 3, 0, "r_h"), 1);
  EXPECT_EQ(value(0, 3, 1, "captured"), one);
  EXPECT_EQ(value(0, 2, 0, "coplanar"), value(0, 2, 0, "total"));
  // Copies behind each other cover the same pixels, and hardly meet.
  EXPECT_NEAR(value(1, 3, 0, "total"), 8 * value(1, 0, 0, "total"), 0.02 * value(1, 3, 0, "total"));
  EXPECT_GT(value(1, 3, 1, "r_h"), 0.97);
  // A pool of an eighth holds an eighth; peeling needs none.
  EXPECT_NEAR(value(2, 0, 0, "r_h"), 0.125, 0.01);
  EXPECT_EQ(value(2, 4, 0, "r_h"), 1);
  EXPECT_EQ(value(2, 0, 1, "captured"), value(2, 4, 1, "captured"));
  EXPECT_EQ(json["sweeps"][3]["points"][1]["width"], 48);
}

TEST(CompareCommand, InterruptedLeavesNothing) {
  const TemporaryFolder folder;
  const Finished done = interrupt_pellucid({"compare", samples().plain, "--frames", "1000", "-o",
                                            folder.file("r.html"), "--json", folder.file("r.json")},
                                           SIGINT, 0.6);
  EXPECT_EQ(done.code, 130) << done.err;
  EXPECT_EQ(done.err, "pellucid: interrupted\n");
  EXPECT_TRUE(folder.files().empty());
}
#endif

}  // namespace
}  // namespace pellucid::testing
