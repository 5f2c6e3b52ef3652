// Tests the report of error against number of buffers: text, JSON by its schema, and SVG.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "markup.h"
#include "pellucid/report.h"
#include "schema.h"

namespace pellucid {
namespace {

using nlohmann::json;
using testing::first_violation;

FrontierReport sample_report(const std::string& name = "knot") {
  FrontierReport report;
  report.input = "knot.ply";
  report.views = "S2,2";
  report.distances = {1.5, kInfiniteDistance};
  report.seed = 1;
  PrimitiveFrontier primitive;
  primitive.name = name;
  primitive.triangles = 12345;
  primitive.vertices = 6200;
  const double iprs[] = {0.08, 0.012, 0.0009, 0.0009, 0};
  for (std::uint32_t k = 1; k <= 5; ++k) {
    FrontierPoint point;
    point.limit = k;
    point.request = point.buffers = k == 4 ? 3 : k;
    point.ipr = iprs[k - 1];
    point.psnr = 30 + 8.0 * k;
    point.memory_bytes = 100000ULL * point.buffers;
    point.violated_weight = point.ipr / 4;
    point.meets_target = point.ipr <= report.max_error;
    primitive.frontier.points.push_back(point);
  }
  primitive.frontier.chosen = 3;
  primitive.frontier.knee = 2;
  report.primitives.push_back(primitive);
  return report;
}

json schema_of_frontier() {
  std::ifstream file(PELLUCID_SCHEMA "/frontier.schema.json");
  return json::parse(file);
}

TEST(FrontierReport, JsonFollowsItsSchema) {
  const json schema = schema_of_frontier();
  FrontierReport report = sample_report();
  json written = json::parse(to_json(report));
  EXPECT_EQ(first_violation(written, schema), "");
  EXPECT_EQ(written["primitives"][0]["points"].size(), 5U);
  EXPECT_EQ(written["primitives"][0]["points"][3]["request"], 3);
  EXPECT_EQ(written["distances"][1], "inf");
  EXPECT_TRUE(written["alpha"].is_null());

  // Every key that is written is in the schema.
  const json& point = schema["properties"]["primitives"]["items"]["properties"]["points"]["items"];
  for (const auto& [key, value] : written.items()) EXPECT_TRUE(schema["properties"].contains(key)) << key;
  for (const auto& [key, value] : written["primitives"][0]["points"][0].items())
    EXPECT_TRUE(point["properties"].contains(key)) << key;

  report.alpha = report.image_alpha = 0.3;
  report.min_psnr = 55;
  report.primitives[0].frontier.knee = 0;
  written = json::parse(to_json(report));
  EXPECT_EQ(first_violation(written, schema), "");
  EXPECT_TRUE(written["max_error"].is_null());
  EXPECT_TRUE(written["primitives"][0]["knee"].is_null());
}

TEST(FrontierReport, TheSchemaCheckCanFail) {
  json written = json::parse(to_json(sample_report()));
  written["primitives"][0]["points"][2]["ipr"] = 1.5;
  EXPECT_NE(first_violation(written, schema_of_frontier()), "");
  written["primitives"][0]["points"][2].erase("ipr");
  EXPECT_NE(first_violation(written, schema_of_frontier()), "");
}

TEST(FrontierReport, TheTableMarksTheChoiceAndTheKnee) {
  const std::string text = to_text(sample_report());
  const std::vector<std::string> lines = testing::lines_of(text);
  const auto line_of = [&](const std::string& start) {
    return *std::find_if(lines.begin(), lines.end(),
                         [&](const std::string& line) { return line.rfind(start, 0) == 0; });
  };
  EXPECT_NE(line_of("2").find("knee"), std::string::npos) << text;
  EXPECT_NE(line_of("3").find("meets the target"), std::string::npos) << text;
  EXPECT_NE(line_of("4").find("3 came out no worse"), std::string::npos) << text;
  EXPECT_EQ(line_of("5").find("meets"), std::string::npos) << text;
}

TEST(FrontierReport, TheSvgIsWellFormedAndMarksTheChoice) {
  FrontierReport report = sample_report("a<b>&\"c\"");
  report.primitives.push_back(sample_report("second").primitives.front());
  for (const bool by_psnr : {false, true}) {
    if (by_psnr) report.min_psnr = 52;
    const std::string svg = frontier_svg(report);
    EXPECT_EQ(testing::first_nesting_error(svg, "<svg"), "");
    EXPECT_EQ(svg.find("a<b>"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    for (const char* text : {"chosen", "knee", "second", "12,345 triangles", "prefers-color-scheme:dark"})
      EXPECT_NE(svg.find(text), std::string::npos) << text;
    EXPECT_NE(svg.find(by_psnr ? "target 52 dB" : "target 0.10 %"), std::string::npos) << svg;
  }
}

TEST(FrontierReport, OnePointGivesAPlotToo) {
  FrontierReport report = sample_report();
  report.max_error = 0;
  OrderFrontier& frontier = report.primitives[0].frontier;
  frontier.points.resize(1);
  frontier.chosen = 1;
  frontier.knee = 0;
  for (const double ipr : {0.0, 1.0}) {
    frontier.points[0].ipr = ipr;
    frontier.points[0].psnr = ipr > 0 ? 3 : 100;
    const std::string svg = frontier_svg(report);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
  }
}

}  // namespace
}  // namespace pellucid
