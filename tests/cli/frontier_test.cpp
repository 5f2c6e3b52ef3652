// Tests `pellucid order` with --frontier, --min-psnr and --alpha.
#include <gtest/gtest.h>

#include <algorithm>

#include "command_line.h"

namespace pellucid::testing {
namespace {

// A coarse knot, few cells.
class Frontier : public ::testing::Test {
 protected:
  void SetUp() override {
    knot_ = folder_.file("knot.glb");
    ASSERT_EQ(run_pellucid({"sample", "torus-knot", "-o", knot_, "--detail", "0.1"}).code, 0);
  }

  [[nodiscard]] Finished order(const Arguments& more) const {
    Arguments arguments{"order", knot_, "--partition", "S0,1", "--distances", "2,inf"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    // Without a model to write nothing is validated.
    if (std::find(more.begin(), more.end(), "-o") != more.end())
      arguments.insert(arguments.end(), {"--check-views", "0"});
    return run_pellucid(arguments);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

 private:
  TemporaryFolder folder_;
  std::string knot_;
};

TEST_F(Frontier, NeedsNoOutput) {
  const Finished done =
      order({"--frontier", file("f.json"), "--frontier", file("f.svg"), "--max-buffers", "3", "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = parse_json_file(file("f.json"));
  EXPECT_EQ(json, nlohmann::json::parse(done.out));
  const auto& points = json["primitives"][0]["points"];
  ASSERT_EQ(points.size(), 3U);
  for (std::size_t k = 1; k < points.size(); ++k) EXPECT_LE(points[k]["ipr"], points[k - 1]["ipr"]);
  EXPECT_NE(slurp(file("f.svg")).find("<svg"), std::string::npos);
}

TEST_F(Frontier, MeasuresUpToEightBuffersByDefault) {
  const Finished done = order({"--frontier", file("f.json"), "--max-error", "auto"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto json = parse_json_file(file("f.json"));
  EXPECT_TRUE(json["max_error"].is_null());
  const auto& points = json["primitives"][0]["points"];
  ASSERT_EQ(points.size(), 8U);
  const std::size_t chosen = json["primitives"][0]["chosen"];
  EXPECT_LE(points[chosen - 1]["frame_time"], 1.05 * points[7]["frame_time"].get<double>());
  EXPECT_NE(done.out.find("wrong pixels"), std::string::npos) << done.out;
}

TEST_F(Frontier, WritesTheChosenNumberOfBuffersToTheOutput) {
  ASSERT_EQ(order({"--frontier", file("f.json"), "--max-error", "0.1", "-o", file("chosen.glb")}).code, 0);
  const auto primitive = parse_json_file(file("f.json"))["primitives"][0];
  const std::size_t chosen = primitive["chosen"];
  EXPECT_TRUE(primitive["points"][chosen - 1]["meets_target"]);
  const int request = primitive["points"][chosen - 1]["request"];
  ASSERT_EQ(order({"--buffers", std::to_string(request), "-o", file("single.glb")}).code, 0);
  EXPECT_TRUE(slurp(file("chosen.glb")) == slurp(file("single.glb")));
}

TEST_F(Frontier, RefusesWhatItCannotWriteBeforeAnyWork) {
  EXPECT_EQ(order({"--frontier", file("f.png")}).code, 2);
  EXPECT_EQ(order({"--frontier", file("missing/f.svg")}).code, 1);
  EXPECT_EQ(order({"--frontier", file("f.svg"), "--buffers", "3"}).code, 2);
  EXPECT_EQ(order({"--frontier", file("f.svg"), "--method", "acyclic"}).code, 2);
  EXPECT_EQ(order({"--max-error", "auto", "-o", file("o.glb"), "--buffers", "3"}).code, 2);
  EXPECT_EQ(order({"--max-error", "auto", "-o", file("o.glb"), "--method", "acyclic"}).code, 2);
  for (const char* wrong : {"", "2", "-0.1", "0.1x", " 0.1", "0x0.1", "nan"}) {
    EXPECT_EQ(order({"--max-error", wrong, "-o", file("o.glb")}).code, 2) << wrong;
  }
}

TEST_F(Frontier, AMissedTargetExitsWith5) {
  const Finished done = order({"--frontier", file("f.json"), "--max-error", "0", "--max-buffers", "1"});
  EXPECT_EQ(done.code, 5) << done.err;
  EXPECT_NE(done.err.find("f.json was written all the same"), std::string::npos) << done.err;
  EXPECT_EQ(count_lines(done.err), 1U);
}

TEST_F(Frontier, PsnrIsATarget) {
  const std::string out = file("out.glb");
  const std::string json = file("out.json");
  ASSERT_EQ(order({"--min-psnr", "45", "-o", out, "--json", json}).code, 0);
  EXPECT_GE(parse_json_file(json)["primitives"][0]["training_psnr"], 45);
  EXPECT_EQ(parse_json_file(json)["picture_alpha"], 0.5);

  const Finished missed = order({"--min-psnr", "99", "--max-buffers", "1", "-o", out});
  EXPECT_EQ(missed.code, 5) << missed.err;
  EXPECT_NE(missed.err.find("dB"), std::string::npos) << missed.err;
  EXPECT_EQ(order({"--min-psnr", "45", "--max-error", "0.1", "-o", out}).code, 2);
  EXPECT_EQ(order({"--min-psnr", "101", "-o", out}).code, 2);
}

TEST_F(Frontier, AlphaIsRecordedAndChangesTheOrders) {
  const auto run = [&](const Arguments& alpha) {
    Arguments arguments{"-o", file("out.glb"), "--json", file("out.json"), "--buffers", "2"};
    arguments.insert(arguments.end(), alpha.begin(), alpha.end());
    EXPECT_EQ(order(arguments).code, 0);
    return slurp(file("out.glb"));
  };
  const std::string by_area = run({});
  EXPECT_TRUE(parse_json_file(file("out.json"))["alpha"].is_null());
  EXPECT_FALSE(run({"--alpha", "0.8"}) == by_area);
  EXPECT_EQ(parse_json_file(file("out.json"))["alpha"], 0.8);
  EXPECT_EQ(order({"--alpha", "0", "-o", file("out.glb")}).code, 2);
  EXPECT_EQ(order({"--alpha", "1.1", "-o", file("out.glb")}).code, 2);
}

}  // namespace
}  // namespace pellucid::testing
