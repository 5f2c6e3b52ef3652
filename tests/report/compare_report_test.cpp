// Tests the comparison of capture techniques: image errors, heat maps, text, JSON by its schema, and charts.
#include "pellucid/compare_report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "comparison.h"
#include "markup.h"
#include "report/charts.h"
#include "report/measure_charts.h"
#include "schema.h"

namespace pellucid {
namespace {

using nlohmann::json;
using testing::first_nesting_error;
using testing::first_violation;
using testing::occurrences;
using testing::sample_comparison;

// -------------------------------------------------------------------------------------------------- images

TEST(ImageErrors, AreThoseOfSrgbOverCoveredPixels) {
  const std::vector<Vec3f> exact{{1, 1, 1}, {0, 0, 0}, {0.5F, 0.5F, 0.5F}};
  EXPECT_EQ(image_error(exact, exact, 2).psnr, 100);
  EXPECT_EQ(image_error(exact, exact, 2).differing, 0U);
  std::vector<Vec3f> drawn = exact;
  drawn[1] = {1, 0, 0};
  const ImageError error = image_error(exact, drawn, 2);
  // One channel of two pixels is wrong by 1: a mean squared error of 1/6.
  EXPECT_NEAR(error.psnr, 7.7815, 1e-3);
  EXPECT_NEAR(error.largest, 1, 1e-9);
  EXPECT_EQ(error.differing, 1U);
}

TEST(DifferenceImage, IsDarkerForLargerErrors) {
  const Image exact{3, 1, {10, 10, 10, 10, 10, 10, 10, 10, 10}};
  const Image drawn{3, 1, {10, 10, 10, 10, 12, 10, 10, 10, 210}};
  const Image image = difference_image(exact, drawn);
  ASSERT_EQ(image.rgb.size(), 9U);
  EXPECT_EQ(image.rgb[0], 255);
  EXPECT_EQ(image.rgb[2], 255);
  EXPECT_LT(image.rgb[5], 255);
  EXPECT_LT(image.rgb[8], image.rgb[5]);
  EXPECT_EQ(image.rgb[6], 140);
}

// A constant error does not flicker; an error that comes and goes does.
TEST(Flickering, IsTheChangeOfTheError) {
  const std::vector<Vec3f> white(8, {1, 1, 1});
  const std::vector<Vec3f> black(8, {0, 0, 0});
  Flicker steady;
  EXPECT_EQ(steady.mean(), std::nullopt);
  for (int i = 0; i < 3; ++i) steady.add(white, black, 8);
  EXPECT_EQ(steady.mean(), 0);
  Flicker moving;
  for (int i = 0; i < 3; ++i) moving.add(i % 2 == 0 ? white : black, white, 4);
  EXPECT_NEAR(moving.mean().value(), 2 * 255, 1e-6);
}

TEST(PerceivedErrors, AreZeroForEqualImages) {
  const std::vector<Vec3f> exact(12 * 9, {0.2F, 0.7F, 0.4F});
  const PerceivedError error = perceived_error(exact, exact, 12, 9, 108);
  EXPECT_NEAR(error.ssim, 1, 1e-12);
  EXPECT_EQ(error.hyab, 0);
}

// For images of one colour both have a closed form. Half of the pixels are covered, so errors count twice.
TEST(PerceivedErrors, OfImagesOfOneColourFollowTheFormulas) {
  const std::vector<Vec3f> white(12 * 9, {1, 1, 1});
  const std::vector<Vec3f> black(12 * 9, {0, 0, 0});
  const PerceivedError error = perceived_error(white, black, 12, 9, 54);
  EXPECT_NEAR(error.ssim, 1 - 2 * (1 - 1e-4 / (1 + 1e-4)), 1e-9);
  EXPECT_NEAR(error.hyab, 200, 1e-3);
  // Red against white: lightness 53.24 and chroma 104.55 (D65).
  const std::vector<Vec3f> red(12 * 9, {1, 0, 0});
  EXPECT_NEAR(perceived_error(white, red, 12, 9, 108).hyab, 100 - 53.24 + 104.55, 0.02);
}

// A shifted edge changes the structure; the same error spread over the image does not.
TEST(PerceivedErrors, SsimRespondsToStructure) {
  std::vector<Vec3f> exact;
  std::vector<Vec3f> shifted;
  std::vector<Vec3f> darker;
  for (int i = 0; i < 32 * 32; ++i) {
    const auto stripe = [](int x) { return x / 4 % 2 == 0 ? 0.6F : 0.2F; };
    exact.push_back(Vec3f{1, 1, 1} * stripe(i % 32));
    shifted.push_back(Vec3f{1, 1, 1} * stripe(i % 32 + 2));
    darker.push_back(Vec3f{1, 1, 1} * (stripe(i % 32) * 0.8F));
  }
  EXPECT_LT(perceived_error(exact, shifted, 32, 32, 1024).ssim, 0.5);
  EXPECT_GT(perceived_error(exact, darker, 32, 32, 1024).ssim, 0.9);
}

// One pixel has three fragments, unsorted, two of them at one depth; the other pixel has none.
TEST(FragmentMaps, CountFragmentsAndCoplanarOnes) {
  RenderResult result;
  result.width = 2;
  result.height = 1;
  result.fragments.offsets = {0, 3, 3};
  result.fragments.fragments = {{0.5F, 0}, {0.25F, 2}, {0.5F, 4}};
  const std::vector<NamedMap> maps = fragment_heat_maps(result, 1);
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0].most, 3);
  EXPECT_EQ(maps[1].most, 2);
  for (const NamedMap& map : maps) {
    EXPECT_LT(map.image.rgb[0], 100);
    EXPECT_EQ(map.image.rgb[3], 255);
  }
  EXPECT_TRUE(fragment_heat_maps(RenderResult{}, 1).empty());
}

TEST(BudgetMaps, AreDarkerForMore) {
  RenderResult result;
  result.width = 3;
  result.height = 1;
  result.maps = {{0, 0.5F, 2}, {0, 1, 7}, {0, 0, 0}};
  const std::vector<NamedMap> maps = budget_heat_maps(result, 1);
  ASSERT_EQ(maps.size(), 3U);
  EXPECT_EQ(maps[1].name, "k");
  EXPECT_NE(maps[1].caption.find("darkest 7"), std::string::npos) << maps[1].caption;
  for (const NamedMap& map : maps) ASSERT_EQ(map.image.rgb.size(), 9U);
  EXPECT_EQ(maps[0].image.rgb[0], 255);
  EXPECT_LT(maps[0].image.rgb[3], 255);
  EXPECT_LT(maps[0].image.rgb[6], maps[0].image.rgb[3]);
  EXPECT_EQ(maps[2].image.rgb[6], 255);
  EXPECT_TRUE(budget_heat_maps(RenderResult{}, 1).empty());
}

// ----------------------------------------------------------------------------------------------------- text

TEST(CompareReport, RatiosAreToTheFastestThatCapturesAll) {
  const CompareReport report = sample_comparison();
  // `sb` is faster, but lost fragments; `f2b` does not promise to capture all.
  ASSERT_NE(report.scenes[0].fastest_exact(), nullptr);
  EXPECT_EQ(report.scenes[0].fastest_exact()->name, "ll");
  const json written = json::parse(to_json(report));
  EXPECT_EQ(written["scenes"][0]["techniques"][1]["ratio"], 2);
  EXPECT_EQ(written["scenes"][0]["techniques"][2]["ratio"], 1);
  EXPECT_EQ(written["scenes"][0]["techniques"][3]["lost"], 100);
  EXPECT_EQ(written["scenes"][0]["c_p"], 0.25);
  EXPECT_EQ(written["scenes"][0]["mean_depth"], 5);
}

TEST(CompareReport, TheTableHasARowForEveryTechnique) {
  const std::string text = to_text(sample_comparison());
  EXPECT_NE(text.find("f2b           no  1.0   0.25       2       0  12.3 KB     15.4       700  0.7000"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("kb: stack needs 64-bit atomics"), std::string::npos) << text;
  EXPECT_NE(text.find("resolution, ms  10x10  20x20  40x40"), std::string::npos) << text;
  EXPECT_EQ(text.find("runs on the CPU"), std::string::npos);
  CompareReport report = sample_comparison();
  report.device.cpu = true;
  EXPECT_NE(to_text(report).find("runs on the CPU"), std::string::npos);
}

// ----------------------------------------------------------------------------------------------------- JSON

json schema_of_compare() {
  std::ifstream file(PELLUCID_SCHEMA "/compare.schema.json");
  return json::parse(file);
}

TEST(CompareReport, JsonFollowsItsSchema) {
  const json schema = schema_of_compare();
  json written = json::parse(to_json(sample_comparison()));
  EXPECT_EQ(first_violation(written, schema), "");
  EXPECT_EQ(written["techniques"], written["scenes"][0]["techniques"]);
  const json& failed = written["scenes"][0]["techniques"][4];
  EXPECT_EQ(failed["failure"], "stack needs 64-bit atomics");
  EXPECT_TRUE(failed["milliseconds"].is_null());
  EXPECT_TRUE(failed["psnr"].is_null());
  EXPECT_TRUE(written["sweeps"][0]["points"][1]["techniques"][1]["bytes"].is_null());

  // Every key that is written is in the schema.
  const json& scene = schema["properties"]["scenes"]["items"]["properties"];
  for (const auto& [key, value] : written.items()) EXPECT_TRUE(schema["properties"].contains(key)) << key;
  for (const auto& [key, value] : written["scenes"][0].items()) EXPECT_TRUE(scene.contains(key)) << key;
  for (const auto& [key, value] : failed.items())
    EXPECT_TRUE(scene["techniques"]["items"]["properties"].contains(key)) << key;

  for (const auto& [key, value] : written["summary"][0].items())
    EXPECT_TRUE(schema["properties"]["summary"]["items"]["properties"].contains(key)) << key;

  written["scenes"][0]["techniques"][0]["r_h"] = 1.5;
  EXPECT_NE(first_violation(written, schema), "");
  EXPECT_EQ(first_violation(json::parse(to_json(CompareReport{})), schema), "");
}

TEST(CompareReport, JsonNamesTheFilesOfImages) {
  CompareReport report = sample_comparison("a b");
  EXPECT_TRUE(json::parse(to_json(report))["scenes"][0]["picture"].is_null());
  report.scenes.push_back(report.scenes.front());
  const json written = json::parse(to_json(report, ImageLinks::beside));
  EXPECT_EQ(first_violation(written, schema_of_compare()), "");
  std::vector<std::string> files;
  for (const ImageFile& file : image_files(report)) files.push_back(file.path);
  EXPECT_EQ(files, (std::vector<std::string>{"images/1-a_b-exact.png", "images/1-a_b-f2b.png",
                                             "images/1-a_b-f2b-difference.png", "images/2-a_b-exact.png",
                                             "images/2-a_b-f2b.png", "images/2-a_b-f2b-difference.png"}));
  const json& techniques = written["scenes"][1]["techniques"];
  EXPECT_EQ(written["scenes"][1]["picture"], files[3]);
  EXPECT_EQ(techniques[0]["picture"], files[4]);
  EXPECT_EQ(techniques[0]["difference"], files[5]);
  EXPECT_EQ(techniques[1]["picture"], files[3]);  // equal
  EXPECT_TRUE(techniques[1]["difference"].is_null());
  EXPECT_TRUE(techniques[4]["picture"].is_null());  // failed
}

// ---------------------------------------------------------------------------------------------------- plots

TEST(CurveCharts, RunLogarithmicallyAndBreakWhereNothingWasMeasured) {
  CurveChart chart;
  chart.title = "time";
  chart.x_values = {1, 2, 4};
  chart.x_text = chart.y_text = [](double v) { return std::to_string(static_cast<int>(v)); };
  chart.curves = {{"a", {{1, 1}, {2, 10}, {4, 100}}}, {"b", {{1, 1}, {2, NAN}, {4, 100}}}, {"c", {}}};
  const std::string svg = curve_chart_svg(chart);
  EXPECT_EQ(first_nesting_error(svg, "<svg"), "");
  // Equal factors are equal steps along both axes.
  EXPECT_NE(svg.find("<polyline points=\"84.0,288.0 442.0,168.0 800.0,48.0\"/>"), std::string::npos) << svg;
  EXPECT_EQ(occurrences(svg, "<polyline"), 3U);
  EXPECT_EQ(occurrences(svg, "<circle"), 5U);
}

TEST(CurveCharts, AxesOfSharesRunFromZeroToOne) {
  CurveChart chart;
  chart.x_values = {1, 2};
  chart.x_text = chart.y_text = [](double) { return ""; };
  chart.is_share = true;
  chart.curves = {{"a", {{1, 0}, {2, 0.5}}}};
  EXPECT_NE(curve_chart_svg(chart).find("<polyline points=\"84.0,288.0 800.0,168.0\"/>"), std::string::npos);
}

TEST(DepthHistogram, HasABarForEveryDepthAsLongAsTheyFit) {
  EXPECT_EQ(occurrences(depth_histogram_svg(std::vector<std::uint64_t>{9, 1, 2, 3}), "<rect"), 3U);
  EXPECT_EQ(occurrences(depth_histogram_svg(std::vector<std::uint64_t>(1001, 1)), "<rect"), 100U);
  EXPECT_EQ(occurrences(depth_histogram_svg({}), "<rect"), 0U);
}

}  // namespace
}  // namespace pellucid
