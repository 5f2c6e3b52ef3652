// Tests `pellucid order` with many models: each has one output, failures are listed, and the other models are
// ordered.
#include <gtest/gtest.h>

#include <csignal>

#include "command_line.h"

namespace pellucid::testing {
namespace {

namespace fs = std::filesystem;

const Arguments kQuick{"--partition", "S0,1", "--distances", "3", "--buffers", "2", "--check-views", "0"};

Arguments order_all(const Arguments& inputs, const std::string& output, const Arguments& more = {}) {
  Arguments arguments{"order"};
  arguments.insert(arguments.end(), inputs.begin(), inputs.end());
  if (!output.empty()) arguments.insert(arguments.end(), {"-o", output});
  arguments.insert(arguments.end(), kQuick.begin(), kQuick.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Some models in a folder of their own: two that are sound, and two that are not.
struct Library {
  Library() {
    goblet = in.file("goblet.glb");
    quad = in.file("quad.obj");
    broken = in.file("broken.ply");
    empty = in.file("empty.obj");
    run_pellucid({"sample", "goblet", "-o", goblet, "--detail", "0.01"});
    spill(quad, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\nf 2 3 5\n");
    spill(broken, "ply\nformat ascii 1.0\nelement vertex 3\n");
    spill(empty, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  }
  TemporaryFolder in, out;
  std::string goblet, quad, broken, empty;
};

TEST(OrderBatch, WritesWhatSingleRunsWrite) {
  const Library library;
  const std::string gltf = library.in.file("small.gltf");
  ASSERT_EQ(run_pellucid({"sample", "goblet", "-o", gltf, "--detail", "0.01"}).code, 0);
  const Arguments inputs{library.goblet, gltf, library.quad};
  const std::vector<const char*> names{"goblet.glb", "small.gltf", "quad.glb"};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    ASSERT_EQ(run_pellucid(order_all({inputs[i]}, library.out.file(names[i]))).code, 0);
  }
  for (const char* threads : {"1", "2"}) {
    const std::string folder = library.out.file(std::string("all-").append(threads)) + "/deep/";
    const std::string json_path = library.out.file("all.json");
    const Finished done =
        run_pellucid(order_all(inputs, folder, {"--threads", threads, "--json", json_path}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    EXPECT_EQ(count_lines(done.out), 4U) << done.out;  // one a file, and the summary
    const nlohmann::json json = parse_json_file(json_path);
    ASSERT_EQ(json["results"].size(), inputs.size());
    EXPECT_TRUE(json["failures"].empty());
    EXPECT_EQ(json["inputs"], inputs.size());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      EXPECT_EQ(json["results"][i]["input"], inputs[i]);
      EXPECT_TRUE(slurp(library.out.file(names[i])) == slurp(folder + names[i])) << names[i];
    }
  }
}

TEST(OrderBatch, AFailureDoesNotStopTheRest) {
  const Library library;
  const std::string missing = library.in.file("missing.obj");
  const std::string folder = library.out.file("out/");
  const std::string json_path = library.out.file("all.json");
  const Finished done = run_pellucid(order_all(
      {library.broken, library.goblet, missing, library.empty, library.quad}, folder, {"--json", json_path}));
  EXPECT_EQ(done.code, 3) << done.err;
  EXPECT_TRUE(fs::exists(folder + "goblet.glb"));
  EXPECT_TRUE(fs::exists(folder + "quad.glb"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2);
  // Each once when it happens, once more at the end, and how many.
  EXPECT_EQ(count_lines(done.err), 7U) << done.err;
  EXPECT_NE(done.err.find("2 of 5 file(s) ordered, 0 skipped, 3 failed"), std::string::npos) << done.err;
  const nlohmann::json json = parse_json_file(json_path);
  EXPECT_EQ(json["results"].size(), 2U);
  ASSERT_EQ(json["failures"].size(), 3U);
  const std::vector<std::pair<std::string, int>> expected{
      {library.broken, 3}, {missing, 3}, {library.empty, 4}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(json["failures"][i]["input"], expected[i].first);
    EXPECT_EQ(json["failures"][i]["exit_code"], expected[i].second);
    const std::string message = json["failures"][i]["message"];
    EXPECT_NE(message.find(expected[i].first), std::string::npos);
    EXPECT_NE(done.err.find("pellucid: failed: " + message + "\n"), std::string::npos) << done.err;
  }
}

TEST(OrderBatch, TheGravestFailureGivesTheExitCode) {
  const Library library;
  const std::string folder = library.out.file("out/");
  const auto code = [&](const Arguments& inputs, const Arguments& more = {}) {
    return run_pellucid(order_all(inputs, folder, more)).code;
  };
  EXPECT_EQ(code({library.empty, library.quad}), 4);
  EXPECT_EQ(code({library.empty, library.goblet}, {"--simplify", "10"}), 2);  // glTF is not simplified
  EXPECT_EQ(code({library.empty, library.goblet, library.broken}, {"--simplify", "10"}), 3);
  // Two buffers are not enough for a knot.
  const std::string knot = library.in.file("knot.glb");
  ASSERT_EQ(run_pellucid({"sample", "torus-knot", "-o", knot, "--detail", "0.1"}).code, 0);
  const Finished missed = run_pellucid(order_all({knot, library.quad}, folder, {"--max-error", "0.0001"}));
  EXPECT_EQ(missed.code, 5) << missed.err;
  EXPECT_NE(missed.err.find("2 of 2 file(s) ordered, 0 skipped, 0 failed, 1 missed the quality asked for"),
            std::string::npos)
      << missed.err;
  EXPECT_TRUE(fs::exists(folder + "knot.glb"));
  EXPECT_EQ(code({knot, library.empty}, {"--max-error", "0.0001"}), 4);
}

TEST(OrderBatch, RefusesConflictingOutputsBeforeAnyWork) {
  const Library library;
  const TemporaryFolder elsewhere;
  const std::string twin = elsewhere.file("quad.stl");
  spill(twin, "solid x\nendsolid x\n");
  const std::string folder = library.out.file("out/");
  const auto expect_usage = [&](const Arguments& arguments, const std::string& part) {
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    EXPECT_NE(done.err.find(part), std::string::npos) << done.err;
    EXPECT_FALSE(fs::exists(folder));
  };
  expect_usage(order_all({library.quad, library.goblet, twin}, folder), twin);
  expect_usage(order_all({library.quad, library.quad}, folder), "both");
  expect_usage(order_all({library.quad, library.goblet}, library.in.file("")), "overwritten");
  expect_usage(order_all({library.quad, library.goblet}, library.out.file("out.glb")), "OUTDIR/");
  expect_usage(order_all({library.quad, library.goblet}, ""), "-o");
  expect_usage(order_all({}, folder), "no model");
}

TEST(OrderBatch, ReadsListsWithComments) {
  const Library library;
  const std::string list = library.in.file("list.txt");
  spill(list, "# models\r\n\n  " + library.quad + "  \r\n\t# " + library.broken + "\n" + library.goblet);
  const std::string folder = library.out.file("out/");
  const Finished done = run_pellucid(order_all({}, folder, {"--model-list", list}));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_TRUE(fs::exists(folder + "quad.glb"));
  EXPECT_TRUE(fs::exists(folder + "goblet.glb"));

  spill(list, "# nothing\n");
  EXPECT_EQ(run_pellucid(order_all({}, folder, {"--model-list", list})).code, 2);
  EXPECT_EQ(run_pellucid(order_all({}, folder, {"--model-list", library.in.file("none.txt")})).code, 3);
}

TEST(OrderBatch, SkipsOutputsThatExist) {
  const Library library;
  const std::string folder = library.out.file("out/");
  const std::string json_path = library.out.file("all.json");
  const Arguments command =
      order_all({library.quad, library.goblet}, folder, {"--skip-existing", "--json", json_path});
  ASSERT_EQ(run_pellucid(order_all({library.quad}, folder)).code, 0);
  spill(folder + "quad.glb", "as it was");
  const Finished done = run_pellucid(command);
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(slurp(folder + "quad.glb"), "as it was");
  EXPECT_EQ(parse_json_file(json_path)["skipped"][0]["input"], library.quad);
  EXPECT_EQ(parse_json_file(json_path)["results"].size(), 1U);
  // A model that has changed since is ordered again.
  fs::last_write_time(library.quad, fs::last_write_time(folder + "quad.glb") + std::chrono::hours(1));
  ASSERT_EQ(run_pellucid(command).code, 0);
  EXPECT_NE(slurp(folder + "quad.glb"), "as it was");
}

TEST(OrderBatch, AnInterruptionKeepsFinishedFiles) {
  const Library library;
  const std::string knot = library.in.file("knot.glb");
  ASSERT_EQ(run_pellucid({"sample", "torus-knot", "-o", knot, "--detail", "2"}).code, 0);
  const std::string folder = library.out.file("out/");
  const std::string records = library.out.file("records");
  const std::string json_path = library.out.file("all.json");
  Arguments command{"order", library.quad,   knot,    library.goblet, "-o",
                    folder,  "--checkpoint", records, "--json",       json_path};
  const Finished done =
      signal_pellucid_when(command, SIGINT, [&] { return fs::exists(records + "/knot.glb/.lock"); });
  EXPECT_EQ(done.code, 130) << done.err;
  EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  EXPECT_NE(done.err.find("interrupted: 1 of 3"), std::string::npos) << done.err;
  EXPECT_NE(done.err.find(records), std::string::npos) << done.err;
  EXPECT_TRUE(fs::exists(folder + "quad.glb"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  EXPECT_FALSE(fs::exists(records + "/quad.glb"));
  const nlohmann::json json = parse_json_file(json_path);
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_EQ(json["results"].size(), 1U);
  EXPECT_TRUE(json["failures"].empty());
}

TEST(OrderBatch, DryRunsPlanAndWriteNothing) {
  const Library library;
  const std::string folder = library.out.file("out/");
  const Finished done = run_pellucid(order_all({library.quad, library.goblet}, folder, {"--dry-run"}));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find(library.quad + " -> " + folder + "quad.glb"), std::string::npos) << done.out;
  EXPECT_TRUE(library.out.files().empty());
}

}  // namespace
}  // namespace pellucid::testing
