// Tests `pellucid measure`: table, JSON, report, several files.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "command_line.h"
#include "pellucid/asset.h"

namespace pellucid::testing {
namespace {

Arguments quick_measure(const Arguments& files, const Arguments& more = {}) {
  Arguments arguments{"measure", "--views", "6", "--size", "64"};
  arguments.insert(arguments.begin() + 1, files.begin(), files.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(MeasureCommand, WritesTheKeysOfTheContract) {
  const Finished done =
      run_pellucid(quick_measure({samples().ordered}, {"--original", samples().plain, "--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const nlohmann::json json = nlohmann::json::parse(done.out);
  for (const char* key : {"schema", "input", "ipr", "psnr", "by_distance", "acmr", "atvr", "overdraw",
                          "viewpoints", "size", "orders"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* name :
       {"ordered", "original", "base", "cache_optimized", "cache_optimized_twins", "centroid_sort"}) {
    EXPECT_TRUE(json["orders"].contains(name)) << name;
  }
  EXPECT_EQ(json["viewpoints"], 6);
  EXPECT_EQ(json["size"], 64);
}

TEST(MeasureCommand, PutsSeveralFilesSideBySide) {
  const TemporaryFolder folder;
  const std::string other = folder.file("ordered.glb");  // the same stem: labels must differ
  ASSERT_EQ(run_pellucid(quick_order(samples().plain, other, {"--no-bake-base"})).code, 0);
  const Finished done =
      run_pellucid(quick_measure({samples().ordered, other}, {"--json", "-", "--no-baselines"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_EQ(json["orders"].size(), 2U);
  EXPECT_TRUE(json["orders"].contains("ordered-2"));
}

TEST(MeasureCommand, MeasuresAFileWithoutOrdersByItself) {
  const Finished done = run_pellucid(quick_measure({samples().plain}, {"--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_TRUE(json["orders"].contains("original"));
  EXPECT_FALSE(json["orders"].contains("base"));
}

// The plain sample with overdraw orders: its own triangles and the reverse.
std::string write_overdraw_sample(const std::string& path) {
  const Model model = read_model(samples().plain);
  std::vector<OrderedPrimitive> ordered;
  for (std::uint32_t p = 0; p < model.primitives.size(); ++p) {
    OrderSet set;
    set.purpose = OrderPurpose::overdraw;
    set.facing = Facing::single;
    set.partition = parse_partition("S0,0");
    set.cell_orders.assign(20, 1);
    set.base_sequence.resize(model.primitives[p].mesh.triangles.size());
    std::iota(set.base_sequence.begin(), set.base_sequence.end(), 0U);
    set.orders.resize(2);
    for (const std::uint32_t t : set.base_sequence) set.orders[0].push_back(node_of(t, false));
    set.orders[1].assign(set.orders[0].rbegin(), set.orders[0].rend());
    ordered.push_back({p, set, {}});
  }
  write_model(model, ordered, path);
  return path;
}

TEST(MeasureCommand, DoesNotMeasureOverdrawOrders) {
  const TemporaryFolder folder;
  const std::string path = write_overdraw_sample(folder.file("overdraw.glb"));
  const Finished done = run_pellucid(quick_measure({path}, {"--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(count_lines(done.err), 1U);
  EXPECT_NE(done.err.find("overdraw orders of"), std::string::npos) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_TRUE(json["orders"].contains("original"));
  EXPECT_FALSE(json["orders"].contains("overdraw"));
  EXPECT_EQ(run_pellucid({"render", path, "-o", folder.file("a.png"), "--order", "buffers"}).code, 4);
  EXPECT_EQ(run_pellucid({"render", path, "-o", folder.file("a.png"), "--order", "error"}).code, 4);
  EXPECT_EQ(run_pellucid({"render", path, "-o", folder.file("a.png"), "--size", "32x32"}).code, 0);
  const Finished inspect = run_pellucid({"inspect", path});
  EXPECT_NE(inspect.out.find("for less overdraw:"), std::string::npos) << inspect.out;
}

void erase_timings(nlohmann::json& json) {
  if (json.is_object()) {
    for (const char* key : {"seconds", "build_seconds", "nanoseconds_per_frame", "milliseconds_per_frame"})
      json.erase(key);
  }
  for (nlohmann::json& value : json) {
    if (value.is_structured()) erase_timings(value);
  }
}

TEST(MeasureCommand, SameNumbersForAnyNumberOfThreads) {
  const auto measure = [](const char* threads) {
    const Finished done = run_pellucid(
        quick_measure({samples().ordered}, {"--json", "-", "--threads", threads, "--no-baselines"}));
    nlohmann::json json = nlohmann::json::parse(done.out);
    erase_timings(json);
    return json;
  };
  EXPECT_EQ(measure("1"), measure("2"));
}

TEST(MeasureCommand, WritesOneSelfContainedPage) {
  const TemporaryFolder folder;
  const std::string page = folder.file("report.html");
  const Finished done =
      run_pellucid(quick_measure({samples().ordered}, {"--original", samples().plain, "--report", page}));
  ASSERT_EQ(done.code, 0) << done.err;
  const std::string html = slurp(page);
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,iVBOR"), std::string::npos);
  EXPECT_EQ(folder.files().size(), 1U);
}

TEST(MeasureCommand, ReportNeedsOrders) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid(quick_measure({samples().plain}, {"--report", folder.file("r.html")}));
  EXPECT_EQ(done.code, 4) << done.err;
  EXPECT_TRUE(folder.files().empty());
}

TEST(MeasureCommand, MeasuresTheBaselinesAskedFor) {
  const Finished done =
      run_pellucid(quick_measure({samples().ordered}, {"--json", "-", "--baselines", "bsp,dptl"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json orders = nlohmann::json::parse(done.out)["orders"];
  EXPECT_EQ(orders.size(), 3U);
  for (const char* name : {"ordered", "bsp", "dptl"}) {
    ASSERT_TRUE(orders.contains(name)) << name;
    EXPECT_GT(orders[name]["nanoseconds_per_frame"], 0.0) << name;
    EXPECT_GT(orders[name]["auxiliary_bytes"], 0) << name;
    EXPECT_LT(orders[name]["ipr"]["mean"], 0.05) << name;
  }
  EXPECT_TRUE(orders["ordered"]["build_seconds"].is_null());
  EXPECT_GT(orders["bsp"]["build_seconds"], 0.0);
  EXPECT_GT(orders["bsp"]["plane_tests"], 0.0);
  EXPECT_LT(orders["ordered"]["nanoseconds_per_frame"], orders["bsp"]["nanoseconds_per_frame"]);
}

TEST(MeasureCommand, RefusesUnknownBaselines) {
  for (const char* list : {"bps", "bsp,", "", "all,bsp"}) {
    const Finished done = run_pellucid(quick_measure({samples().ordered}, {"--baselines", list}));
    EXPECT_EQ(done.code, 2) << list << ": " << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  }
  EXPECT_EQ(run_pellucid(quick_measure({samples().ordered}, {"--baselines", "bsp", "--no-baselines"})).code,
            2);
}

TEST(MeasureCommand, RefusesInvalidDistanceRanges) {
  for (const char* distances : {"5,2", "0.5,2", "2", "2,inf", "a,b", "2,5x"}) {
    const Finished done = run_pellucid(quick_measure({samples().ordered}, {"--distance-range", distances}));
    EXPECT_EQ(done.code, 2) << distances << ": " << done.err;
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
  }
}

}  // namespace
}  // namespace pellucid::testing
