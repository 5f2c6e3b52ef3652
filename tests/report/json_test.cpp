// Tests the keys of the JSON, which are a contract.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "handmade.h"
#include "pellucid/report.h"

namespace pellucid {
namespace {

using Json = nlohmann::json;

void expect_keys(const Json& json, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(json.contains(key)) << key;
}

OrderReport order_report() {
  OrderReport report;
  report.input = "in.ply";
  report.output = "out.glb";
  report.method = "budget";
  report.views = "S2,2";
  report.seed = 7;
  report.distances = {1.5, kInfiniteDistance};
  for (std::uint32_t k = 0; k < 2; ++k) {
    PrimitiveOrderReport primitive;
    primitive.name = "part";
    primitive.primitive = k;
    primitive.triangles = 100 * (k + 1);
    primitive.vertices = 50;
    primitive.buffers.assign(k + 1, {10, 7, 0.7, 1.1});
    primitive.memory_bytes = 60;
    primitive.statistics.dropped_edges = 3;
    primitive.statistics.dropped_weight = k == 0 ? 0.3 : 0.0;
    primitive.statistics.seconds.graph = 0.5;
    report.primitives.push_back(primitive);
  }
  return report;
}

TEST(JsonContract, Order) {
  const Json json = Json::parse(to_json(order_report()));
  expect_keys(
      json, {"schema", "input", "triangles", "vertices", "method", "views", "seed", "buffer_count", "buffers",
             "memory_bytes", "disk_bytes", "dropped_edges", "cyclic_cells", "seconds", "peak_rss_bytes"});
  expect_keys(json["buffers"][0], {"triangles", "acmr", "acmr_drawn", "misses"});
  expect_keys(json["dropped_edges"], {"count", "weight"});
  expect_keys(json["primitives"][0], {"violated_weight", "violated_floor", "violated_bound", "regions",
                                      "switches_per_turn", "clusters_lower_bound"});
  expect_keys(json["seconds"], {"total", "read", "graph", "cluster", "sequence", "write"});
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["triangles"], 300);
  EXPECT_EQ(json["buffer_count"], 3);
  EXPECT_EQ(json["memory_bytes"], 120);
  EXPECT_EQ(json["dropped_edges"]["count"], 6);
  EXPECT_NEAR(json["dropped_edges"]["weight"].get<double>(), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(json["seconds"]["graph"].get<double>(), 1.0);
  EXPECT_EQ(json["distances"][1], "inf");
}

TEST(JsonContract, OrderOfWhatWasSplit) {
  OrderReport report = order_report();
  report.primitives[0].split = SplitReport{151, 2, 162, 7, 1, 332, 12, true};
  report.primitives[0].ipr_unavoidable = 0.004;
  const Json json = Json::parse(to_json(report));
  const Json& split = json["primitives"][0]["split"];
  EXPECT_EQ(split["intersecting_pairs"], Json({{"before", 151}, {"after", 2}}));
  EXPECT_EQ(split["cyclic_viewpoints"], Json({{"of", 162}, {"before", 7}, {"after", 1}}));
  EXPECT_EQ(split["added_triangles"], Json({{"intersections", 332}, {"cycles", 12}}));
  EXPECT_EQ(split["limit_met"], true);
  EXPECT_EQ(json["primitives"][0]["ipr_unavoidable"], 0.004);
  EXPECT_TRUE(json["primitives"][1]["split"].is_null());
  EXPECT_TRUE(json["primitives"][1]["ipr_unavoidable"].is_null());
  const std::string text = to_text(report);
  EXPECT_NE(
      text.find("intersecting pairs 151, left 2; viewpoints with cycles 7 of 162, left 1; 344 triangles"),
      std::string::npos);
  EXPECT_NE(text.find("344 triangles added, which is the limit of new triangles"), std::string::npos) << text;
  EXPECT_EQ(text.find("--"), std::string::npos) << "a library does not know options of the command line";
  EXPECT_NE(text.find("no order avoids, as faces intersect or overlap in cycles: 0.40 %"), std::string::npos)
      << text;
}

TEST(JsonContract, Measure) {
  const Json json = Json::parse(to_json(testing::measured("quad")));
  expect_keys(json, {"schema", "input", "ipr", "psnr", "by_distance", "acmr", "atvr", "overdraw",
                     "viewpoints", "size", "orders"});
  expect_keys(json["ipr"], {"mean", "max"});
  expect_keys(json["psnr"], {"mean", "min"});
  expect_keys(json["by_distance"][0], {"distance", "ipr", "psnr"});
  expect_keys(json["acmr_by_cache"], {"fifo16", "fifo20", "fifo32", "lru16", "lru32"});
  expect_keys(json["orders"], {"a", "original", "centroid_sort"});
  expect_keys(json["orders"]["a"],
              {"memory_bytes", "auxiliary_bytes", "build_seconds", "nanoseconds_per_frame",
               "milliseconds_per_frame", "triangles_submitted", "plane_tests", "splits"});
  expect_keys(json["primitives"][0], {"notes"});
  EXPECT_DOUBLE_EQ(json["ipr"]["mean"].get<double>(), 0.01);
  EXPECT_DOUBLE_EQ(json["orders"]["original"]["ipr"]["mean"].get<double>(), 0.25);
}

TEST(JsonContract, SeveralPrimitivesArePooled) {
  MeasureReport report = testing::measured("one");
  report.primitives.push_back(report.primitives.front());
  report.primitives[1].methods[0].quality.ipr_mean = 0.03;
  report.primitives[1].methods[0].quality.ipr_max = 0.5;
  report.primitives[1].methods[0].quality.psnr_min = 12;
  report.primitives[0].methods[0].acmr_by_cache[1] = 0.5;
  report.primitives[1].methods[0].acmr_by_cache[1] = 0.7;
  const Json json = Json::parse(to_json(report));
  EXPECT_DOUBLE_EQ(json["ipr"]["mean"].get<double>(), 0.02);
  EXPECT_DOUBLE_EQ(json["ipr"]["max"].get<double>(), 0.5);
  EXPECT_DOUBLE_EQ(json["psnr"]["min"].get<double>(), 12);
  EXPECT_EQ(json["buffer_count"], 4);
  EXPECT_DOUBLE_EQ(json["acmr_by_cache"]["fifo20"].get<double>(), 0.6);
  EXPECT_EQ(json["primitives"].size(), 2U);
}

TEST(JsonContract, NamesThatAreNotUtf8DoNotBreakIt) {
  OrderReport report = order_report();
  report.primitives[0].name = "bad \xff name";
  EXPECT_TRUE(Json::accept(to_json(report)));
}

TEST(JsonContract, Inspect) {
  Model model;
  model.path = "a.glb";
  model.format = "glb";
  Primitive primitive;
  primitive.name = "quad";
  primitive.mesh = testing::two_triangles();
  primitive.orders = testing::two_orders();
  model.primitives = {primitive};
  model.instances = {{"node", 0, {}}};
  const Json json = Json::parse(inspect_json(model));
  expect_keys(json, {"schema", "input", "format", "primitives", "instances", "animations", "notes"});
  EXPECT_EQ(json["primitives"][0]["orders"]["buffer_count"], 2);
  EXPECT_EQ(json["primitives"][0]["orders"]["valid_to"], "inf");
  EXPECT_EQ(json["primitives"][0]["check"]["boundary_edges"], 4);
  EXPECT_EQ(json["primitives"][0]["orders"]["purpose"], "transparency");
  EXPECT_FALSE(json["primitives"][0]["orders"].contains("patch_count"));
  EXPECT_NE(inspect_text(model).find("2 orders over S0,0"), std::string::npos);
}

TEST(JsonContract, InspectShowsOverdrawOrders) {
  Model model;
  model.path = "a.glb";
  model.animation_names = {"walk", "run"};
  Primitive primitive;
  primitive.mesh = testing::two_triangles();
  OrderSet orders = testing::two_orders();
  orders.purpose = OrderPurpose::overdraw;
  orders.facing = Facing::single;
  orders.orders = {{0, 2}, {2, 0}};
  orders.patch_offsets = {0, 2};
  orders.model_ranks = {4, 3};
  orders.animations = {
      {1, {0.5, 0.75, 1.25}, std::vector<BoundingSphere>(3), std::vector<std::uint32_t>(60)}};
  primitive.orders = orders;
  model.primitives = {primitive};
  const Json shown = Json::parse(inspect_json(model))["primitives"][0]["orders"];
  EXPECT_EQ(shown["purpose"], "overdraw");
  EXPECT_EQ(shown["buffer_count"], 2);
  EXPECT_EQ(shown["patch_count"], 1);
  EXPECT_EQ(shown["model_ranks"], Json({4, 3}));
  const Json animation = {
      {"animation", 1}, {"name", "run"}, {"key_frames", 3}, {"first_time", 0.5}, {"last_time", 1.25}};
  EXPECT_EQ(shown["animations"], Json::array({animation}));
  const std::string text = inspect_text(model);
  EXPECT_NE(text.find("for less overdraw: 1 patches, ranked among the model's meshes"), std::string::npos);
  EXPECT_NE(text.find("animation 1 (run): 3 key frames from 0.50 to 1.25 s"), std::string::npos);

  model.primitives[0].orders->patch_offsets.clear();
  EXPECT_EQ(Json::parse(inspect_json(model))["primitives"][0]["orders"]["patch_count"], 2);
}

}  // namespace
}  // namespace pellucid
