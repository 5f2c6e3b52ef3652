// Tests `pellucid order`: results, exit codes, determinism, interruption.
#include <gtest/gtest.h>

#include <csignal>

#include "command_line.h"

namespace pellucid::testing {
namespace {

TEST(OrderCommand, WritesAFileThatHoldsTheOrdersAskedFor) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  const std::string json_path = folder.file("out.json");
  const Finished done = run_pellucid(quick_order(samples().plain, out, {"--json", json_path}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("ACMR"), std::string::npos);
  const nlohmann::json json = parse_json_file(json_path);
  for (const char* key :
       {"schema", "input", "triangles", "vertices", "method", "views", "seed", "buffer_count", "buffers",
        "memory_bytes", "disk_bytes", "dropped_edges", "cyclic_cells", "seconds", "peak_rss_bytes"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["method"], "budget");
  EXPECT_EQ(json["views"], "S0,1");
  EXPECT_EQ(json["input"], samples().plain);
  for (const auto& primitive : json["primitives"]) EXPECT_EQ(primitive["buffer_count"], 2);

  const Finished inspect = run_pellucid({"inspect", out, "--json", "-"});
  const nlohmann::json found = nlohmann::json::parse(inspect.out);
  EXPECT_EQ(found["primitives"][0]["orders"]["buffer_count"], 2);
  EXPECT_EQ(found["primitives"][0]["orders"]["partition"], "S0,1");
}

TEST(OrderCommand, ViewTrianglesAndRegionsAreOrderedWrittenAndMeasured) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  for (const char* views : {"T0", "R0"}) {
    for (const char* method : {"budget", "acyclic"}) {
      std::vector<std::string> arguments{
          "order", samples().plain, "-o", out,           "--partition", views, "--method",
          method,  "--check-views", "0",  "--distances", "2,5"};
      const Finished done = run_pellucid(arguments);
      ASSERT_EQ(done.code, 0) << done.err;
      const Finished inspect = run_pellucid({"inspect", out, "--json", "-"});
      EXPECT_EQ(nlohmann::json::parse(inspect.out)["primitives"][0]["orders"]["partition"], views);
      const Finished measure = run_pellucid({"measure", out, "--views", "4", "--size", "64", "--json", "-"});
      ASSERT_EQ(measure.code, 0) << measure.err;
      EXPECT_TRUE(nlohmann::json::parse(measure.out).contains("ipr"));
    }
  }
}

TEST(OrderCommand, ReportsTheCacheMethodWhichChangesTheOrders) {
  const TemporaryFolder folder;
  const auto misses = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"--json", folder.file("out.json")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished done = run_pellucid(quick_order(samples().plain, folder.file("out.glb"), arguments));
    EXPECT_EQ(done.code, 0) << done.err;
    const nlohmann::json json = parse_json_file(folder.file("out.json"));
    EXPECT_EQ(json["cache_method"], options.size() > 1 && options[1] == "tipsify" ? "tipsify" : "scheduled");
    int sum = 0;
    for (const auto& buffer : json["buffers"]) sum += buffer["misses"].get<int>();
    return sum;
  };
  const int scheduled = misses({});
  EXPECT_LT(scheduled, misses({"--cache-method", "tipsify"}));
  EXPECT_LE(scheduled, misses({"--cache-slack", "0"}));
}

TEST(OrderCommand, PrintsNothingToStderrOnSuccess) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid(quick_order(samples().plain, folder.file("out.glb"), {"--quiet"}));
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(run_pellucid(quick_order(samples().plain, folder.file("out.glb"))).err, "");
}

TEST(OrderCommand, SameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (const char* method : {"budget", "acyclic"}) {
    std::string bytes;
    for (const char* threads : {"1", "2"}) {
      const std::string out = folder.file("out.glb");
      const Finished done =
          run_pellucid({"order", samples().plain, "-o", out, "--partition", "S0,1", "--distances", "2,inf",
                        "--method", method, "--threads", threads, "--check-views", "2"});
      ASSERT_EQ(done.code, 0) << done.err;
      if (bytes.empty()) bytes = slurp(out);
      EXPECT_TRUE(bytes == slurp(out)) << method << " with " << threads << " threads";
    }
  }
}

TEST(OrderCommand, EveryEncodingAndDirectionIsReadBack) {
  const TemporaryFolder folder;
  const std::vector<std::pair<const char*, const char*>> pairs{
      {"indices", "back-to-front"}, {"patches", "front-to-back"}, {"meshopt", "back-to-front"}};
  for (const auto& [encoding, direction] : pairs) {
    const std::string out = folder.file("out.gltf");
    const Finished done = run_pellucid(quick_order(
        samples().plain, out, {"--encoding", encoding, "--direction", direction, "--split-buffer"}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(run_pellucid({"inspect", out}).code, 0) << encoding << " " << direction;
  }
}

TEST(OrderCommand, MissedQualityExitsWith5AndWritesTheFile) {
  const TemporaryFolder folder;
  const std::string knot = folder.file("knot.glb");
  const std::string out = folder.file("out.glb");
  ASSERT_EQ(run_pellucid({"sample", "torus-knot", "-o", knot, "--detail", "0.1"}).code, 0);
  const Finished done = run_pellucid({"order", knot, "-o", out, "--partition", "S0,1", "--max-buffers", "1",
                                      "--max-error", "0.0000001", "--check-views", "0"});
  EXPECT_EQ(done.code, 5) << done.err;
  EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  EXPECT_TRUE(std::filesystem::exists(out));
}

TEST(OrderCommand, NothingToOrderExitsWith4) {
  const TemporaryFolder folder;
  const std::string points = folder.file("points.obj");
  spill(points, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  const Finished done = run_pellucid(quick_order(points, folder.file("out.glb")));
  EXPECT_TRUE(done.code == 4 || done.code == 3) << done.code << done.err;
  EXPECT_NE(done.err.find("points.obj"), std::string::npos) << done.err;

  // All its triangles vanish when cleaned.
  const std::string flat = folder.file("flat.obj");
  spill(flat, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const Finished degenerate = run_pellucid(quick_order(flat, folder.file("out.glb")));
  EXPECT_EQ(degenerate.code, 4) << degenerate.err;
  EXPECT_NE(degenerate.err.find("flat.obj"), std::string::npos) << degenerate.err;
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.glb")));
}

TEST(OrderCommand, StrictRefusesWhatCleaningWouldDrop) {
  const TemporaryFolder folder;
  const std::string path = folder.file("mixed.obj");
  spill(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");
  EXPECT_EQ(run_pellucid(quick_order(path, folder.file("out.glb"))).code, 0);
  const Finished strict = run_pellucid(quick_order(path, folder.file("strict.glb"), {"--strict"}));
  EXPECT_EQ(strict.code, 3) << strict.err;
  EXPECT_EQ(count_lines(strict.err), 1U) << strict.err;
  EXPECT_FALSE(std::filesystem::exists(folder.file("strict.glb")));
}

TEST(OrderCommand, SimplifiesOtherFormatsButNotGltf) {
  const TemporaryFolder folder;
  std::string grid;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) {
      grid += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string((x * y) % 3) + "\n";
    }
  }
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 11; ++x) {
      const int a = 12 * y + x + 1;
      grid += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + 13) + " " +
              std::to_string(a + 12) + "\n";
    }
  }
  const std::string path = folder.file("grid.obj");
  spill(path, grid);
  const std::string json = folder.file("s.json");
  const Finished done =
      run_pellucid(quick_order(path, folder.file("out.glb"), {"--simplify", "100", "--json", json}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_LE(parse_json_file(json)["triangles"].get<int>(), 100);
  EXPECT_GT(parse_json_file(json)["triangles"].get<int>(), 10);

  EXPECT_EQ(run_pellucid(quick_order(samples().plain, folder.file("no.glb"), {"--simplify", "5"})).code, 2);
}

TEST(OrderCommand, DryRunWritesNothing) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid({"order", samples().plain, "-o", folder.file("out.glb"), "--dry-run"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("dry run"), std::string::npos);
  EXPECT_TRUE(folder.files().empty());
}

TEST(OrderCommand, InterruptedLeavesNothing) {
  const TemporaryFolder input;
  const std::string knot = input.file("knot.glb");
  ASSERT_EQ(run_pellucid({"sample", "torus-knot", "-o", knot, "--detail", "2"}).code, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const Finished done = interrupt_pellucid(
        {"order", knot, "-o", folder.file("out.glb"), "--json", folder.file("out.json")}, signal, 0.8);
    EXPECT_EQ(done.code, 130) << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    EXPECT_TRUE(folder.files().empty());
  }
}

}  // namespace
}  // namespace pellucid::testing
