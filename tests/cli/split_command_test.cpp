// Tests `pellucid order --split`.
#include <gtest/gtest.h>

#include "command_line.h"

namespace pellucid::testing {
namespace {

// Two boards of 8 triangles each that pass through each other.
std::string crossing_boards() {
  std::string text;
  for (int board = 0; board < 2; ++board) {
    for (int i = 0; i < 9; ++i) {
      const int row = i / 3;
      const double u = i % 3 - 1.0;
      const double v = row - 1.0 + 0.13 * board;
      text += "v " + std::to_string(u) + ' ' + std::to_string(board == 0 ? v : 0.21) + ' ' +
              std::to_string(board == 0 ? 0.07 : v) + '\n';
    }
  }
  for (int board = 0; board < 2; ++board) {
    for (const int corner : {1, 2, 4, 5}) {
      const int a = 9 * board + corner;
      for (const auto& t : {std::array{a, a + 1, a + 4}, std::array{a, a + 4, a + 3}}) {
        text.append("f ").append(std::to_string(t[0])).append(" ").append(std::to_string(t[1]));
        text.append(" ").append(std::to_string(t[2])).append("\n");
      }
    }
  }
  return text;
}

nlohmann::json order(const std::string& input, const std::string& output, const Arguments& more,
                     const std::string& json) {
  Arguments arguments{"order", input,           "-o", output,   "--partition", "S0,1", "--buffers",
                      "4",     "--check-views", "8",  "--json", json};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished done = run_pellucid(arguments);
  EXPECT_EQ(done.code, 0) << done.err;
  return parse_json_file(json);
}

TEST(SplitCommand, CutsIntersectingFacesAndReportsIt) {
  const TemporaryFolder folder;
  const std::string input = folder.file("boards.obj");
  spill(input, crossing_boards());
  const nlohmann::json whole = order(input, folder.file("whole.glb"), {}, folder.file("a.json"));
  const nlohmann::json split = order(input, folder.file("split.glb"), {"--split"}, folder.file("b.json"));
  const nlohmann::json& before = whole["primitives"][0];
  const nlohmann::json& after = split["primitives"][0];
  EXPECT_TRUE(before["split"].is_null());
  EXPECT_GT(before["intersecting_pairs"], 0);
  EXPECT_GT(before["ipr_unavoidable"].get<double>(), 0.01);
  EXPECT_GE(before["error"]["ipr"]["mean"].get<double>(), before["ipr_unavoidable"].get<double>());
  EXPECT_EQ(whole["triangles"], 16);
  EXPECT_GT(after["split"]["intersecting_pairs"]["before"], 0);
  EXPECT_EQ(after["split"]["intersecting_pairs"]["after"], 0);
  EXPECT_EQ(after["split"]["limit_met"], false);
  const int added = after["split"]["added_triangles"]["intersections"].get<int>() +
                    after["split"]["added_triangles"]["cycles"].get<int>();
  EXPECT_GT(added, 0);
  EXPECT_EQ(split["triangles"], 16 + added);
  EXPECT_LT(after["error"]["ipr"]["mean"].get<double>(), before["error"]["ipr"]["mean"].get<double>() / 5);

  // A glTF is split, too, whatever orders it came with.
  const nlohmann::json again =
      order(folder.file("whole.glb"), folder.file("again.gltf"), {"--split"}, folder.file("c.json"));
  EXPECT_GT(again["triangles"], 16);
  EXPECT_EQ(again["primitives"][0]["split"]["intersecting_pairs"]["after"], 0);
  const Finished inspect = run_pellucid({"inspect", folder.file("again.gltf"), "--json", "-"});
  EXPECT_EQ(inspect.code, 0) << inspect.err;
  EXPECT_EQ(nlohmann::json::parse(inspect.out)["primitives"][0]["check"]["triangles"], again["triangles"]);
}

TEST(SplitCommand, KeepsToItsLimit) {
  const TemporaryFolder folder;
  const std::string input = folder.file("boards.obj");
  spill(input, crossing_boards());
  const nlohmann::json json =
      order(input, folder.file("out.glb"), {"--split", "--split-limit", "0.2"}, folder.file("a.json"));
  EXPECT_LE(json["triangles"], 16 + 4);
  EXPECT_EQ(json["primitives"][0]["split"]["limit_met"], true);
  EXPECT_GT(json["primitives"][0]["split"]["intersecting_pairs"]["after"], 0);
  EXPECT_EQ(run_pellucid({"order", input, "-o", folder.file("b.glb"), "--split-limit", "1"}).code, 2);
}

}  // namespace
}  // namespace pellucid::testing
