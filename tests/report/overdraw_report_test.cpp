// Tests the heat maps, the chart and the page of an overdraw report.
#include "pellucid/overdraw_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "markup.h"
#include "pellucid/report.h"
#include "report/heat_maps.h"

namespace pellucid {
namespace {

OverdrawRow row(const std::string& name, std::vector<double> by_frame) {
  OverdrawRow row;
  row.name = name;
  row.acmr = 0.85;
  row.key_frames.name = name;
  double sum = 0;
  for (const double value : by_frame) {
    sum += value;
    row.key_frames.max = std::max(row.key_frames.max, value + 0.25);
  }
  row.key_frames.mean = by_frame.empty() ? 0 : sum / static_cast<double>(by_frame.size());
  row.key_frames.by_frame = std::move(by_frame);
  return row;
}

// Returns a report with clips of these numbers of key frames, one after the other.
OverdrawReport report_of(const std::vector<std::uint64_t>& clip_lengths, std::vector<OverdrawRow> rows) {
  OverdrawReport report;
  report.input = "dir/knight.glb";
  report.method = "refined";
  report.triangles = 12996;
  report.parts = 1;
  report.rows = std::move(rows);
  for (std::uint32_t c = 0; c < clip_lengths.size(); ++c) {
    report.clips.push_back({"motion " + std::to_string(c), clip_lengths[c]});
    for (std::uint64_t f = 0; f < clip_lengths[c]; ++f)
      report.frames.push_back({c, static_cast<double>(f) / 30});
  }
  return report;
}

HeatMap map_of(std::uint32_t size, std::vector<std::uint32_t> shaded, const std::string& label = "map") {
  return {label, size, std::move(shaded)};
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

Rgb pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::size_t at = 3 * (std::size_t{y} * image.width + x);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

// Returns the points of all polylines of the first curve with this tooltip.
std::vector<std::string> curve_points(const std::string& svg, const std::string& name) {
  std::vector<std::string> points;
  const std::size_t begin = svg.find("<title>" + name + "</title>");
  const std::size_t end = svg.find("</g>", begin);
  constexpr std::string_view kStart = "<polyline points=\"";
  for (std::size_t at = svg.find(kStart, begin); at < end; at = svg.find(kStart, at)) {
    at += kStart.size();
    points.push_back(svg.substr(at, svg.find('"', at) - at));
  }
  return points;
}

// ------------------------------------------------------------------------------------------------ heat maps

TEST(HeatMapColors, AreDarkerForMoreFragments) {
  const Image image = heat_image(map_of(2, {0, 1, 2, 5}));
  EXPECT_EQ(pixel(image, 0, 0), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(image, 1, 0), (Rgb{218, 228, 239}));
  EXPECT_EQ(pixel(image, 0, 1), (Rgb{226, 170, 87}));
  EXPECT_EQ(pixel(image, 1, 1), (Rgb{68, 16, 24}));
  EXPECT_EQ(heat_color(1000), heat_color(5));
  const auto luminance = [](const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  for (std::uint32_t shaded = 0; shaded < 5; ++shaded)
    EXPECT_GT(luminance(heat_color(shaded)), luminance(heat_color(shaded + 1)) + 20) << shaded;
}

TEST(ContactSheet, PutsMethodsInRowsAndFramesInColumns) {
  const Image image = contact_sheet({{map_of(2, {1, 1, 1, 1}), map_of(2, {2, 2, 2, 2})},
                                     {map_of(2, {3, 3, 3, 3}), map_of(2, {4, 4, 4, 5})}});
  EXPECT_EQ(image.width, 6U);
  EXPECT_EQ(image.height, 6U);
  EXPECT_EQ(pixel(image, 0, 0), heat_color(1));
  EXPECT_EQ(pixel(image, 4, 0), heat_color(2));
  EXPECT_EQ(pixel(image, 0, 4), heat_color(3));
  EXPECT_EQ(pixel(image, 4, 4), heat_color(4));
  EXPECT_EQ(pixel(image, 5, 5), heat_color(5));
  EXPECT_EQ(pixel(image, 2, 0), pixel(image, 3, 3));  // gutters
  EXPECT_FALSE(encode_png(image).empty());
}

TEST(ContactSheet, TakesRowsAndMapsOfDifferentSize) {
  const Image image =
      contact_sheet({{map_of(1, {1})}, {}, {map_of(2, {2, 2, 2, 2}), map_of(0, {}), map_of(1, {3})}});
  EXPECT_EQ(image.width, 3 * 2 + 2 * 2U);
  EXPECT_EQ(image.height, 3 * 2 + 2 * 2U);
  EXPECT_EQ(image.rgb.size(), std::size_t{3} * image.width * image.height);
  EXPECT_EQ(pixel(image, 0, 0), heat_color(1));
  EXPECT_EQ(pixel(image, 1, 9), heat_color(2));
  EXPECT_EQ(pixel(image, 8, 8), heat_color(3));
  const Rgb nothing = pixel(image, 2, 0);
  for (const auto& [x, y] : {std::pair{1U, 0U}, {4U, 0U}, {0U, 4U}, {4U, 8U}, {9U, 8U}})
    EXPECT_EQ(pixel(image, x, y), nothing) << x << ' ' << y;
}

TEST(ContactSheet, IsEmptyWithoutMapsAndRefusesWrongSizes) {
  EXPECT_TRUE(contact_sheet({}).rgb.empty());
  EXPECT_TRUE(contact_sheet({{}, {}}).rgb.empty());
  EXPECT_THROW(contact_sheet({{map_of(2, {1, 1, 1})}}), Error);
  EXPECT_THROW(heat_image(map_of(1, {1, 1})), Error);
}

// ---------------------------------------------------------------------------------------------------- chart

// The plot is x 60 .. 800 and y 300 (overdraw 1) .. 60.
TEST(OverdrawChart, PutsValuesWhereTheyBelong) {
  // The axis ends at 1.5: 480 pixels per unit of overdraw. Frames are 185 pixels wide.
  const std::string svg = overdraw_chart(report_of({4}, {row("paper", {1, 1.25, 1.5, 1.1})}));
  EXPECT_EQ(curve_points(svg, "paper"),
            std::vector<std::string>{"152.5,300.0 337.5,180.0 522.5,60.0 707.5,252.0"});
  EXPECT_EQ(testing::first_nesting_error(svg, "<svg"), "");
  for (const char* text : {">1.0<", ">1.5<", ">paper 1.212<", ">motion 0<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_EQ(svg.find(">1.6<"), std::string::npos);
}

TEST(OverdrawChart, BreaksCurvesBetweenClipsAndWhereNothingIsSeen) {
  const std::string svg =
      overdraw_chart(report_of({2, 5, 1}, {row("a", {1.5, 1.5, 1.5, 1.5, 0, 1.5, 0, 1.5})}));
  // Eight frames of 92.5 pixels; lone ones are drawn from edge to edge.
  const std::vector<std::string> expected{"106.2,60.0 198.8,60.0", "291.2,60.0 383.8,60.0",
                                          "522.5,60.0 615.0,60.0", "707.5,60.0 800.0,60.0"};
  EXPECT_EQ(curve_points(svg, "a"), expected);
  EXPECT_EQ(count_of(svg, "class=\"clip\""), 2 + 2U);  // separators, and those beside names
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(OverdrawChart, AveragesManyKeyFramesWithinTheirClips) {
  // 600 frames: 300 points, 2 frames each; the last clip keeps one of its own.
  std::vector<double> values(600);
  for (std::size_t f = 0; f < 599; ++f) values[f] = f % 2 == 0 ? 1.0 : 1.25;
  values[599] = 1.5;
  const std::string svg = overdraw_chart(report_of({400, 199, 1}, {row("a", values)}));
  const std::vector<std::string> curves = curve_points(svg, "a");
  ASSERT_EQ(curves.size(), 3U);
  EXPECT_EQ(count_of(curves[0], ","), 200U);
  EXPECT_EQ(count_of(curves[1], ","), 99U);
  // Mean 1.125 at the middle of frames 0 and 1.
  EXPECT_EQ(curves[0].substr(0, 11), "61.2,240.0 ");
  EXPECT_EQ(curves[2], "798.8,60.0 800.0,60.0");
}

TEST(OverdrawChart, KeepsEveryKeyFrameUpToThreeHundred) {
  const std::string svg = overdraw_chart(report_of({300}, {row("a", std::vector<double>(300, 1.5))}));
  EXPECT_EQ(count_of(curve_points(svg, "a").at(0), ","), 300U);
  const std::string more = overdraw_chart(report_of({301}, {row("a", std::vector<double>(301, 1.5))}));
  EXPECT_EQ(count_of(curve_points(more, "a").at(0), ","), 300U);
}

TEST(OverdrawChart, NamesOnlyAsManyClipsAsThereIsRoomFor) {
  const std::vector<std::uint64_t> lengths(400, 2);
  const std::string svg = overdraw_chart(report_of(lengths, {row("a", std::vector<double>(800, 1.5))}));
  const std::size_t names = count_of(svg, "<title>motion ");
  EXPECT_GE(names, 7U);
  EXPECT_LE(names, 10U);
  EXPECT_EQ(count_of(svg, "class=\"clip\""), names - 1);
  EXPECT_EQ(curve_points(svg, "a").size(), 400U);
}

TEST(OverdrawChart, GivesNamesToLongClipsFirst) {
  const std::string svg = overdraw_chart(report_of({2, 1, 97}, {row("a", std::vector<double>(100, 1.5))}));
  EXPECT_EQ(svg.find(">motion 0<"), std::string::npos);
  EXPECT_EQ(svg.find(">motion 1<"), std::string::npos);
  EXPECT_NE(svg.find("<text x=\"86.2\" y=\"319.0\" text-anchor=\"start\" class=\"small soft\">motion 2<"),
            std::string::npos);
}

// Returns the heights of the names beside the curves, sorted.
std::vector<double> label_heights(const std::string& svg) {
  std::vector<double> heights;
  constexpr std::string_view kLabel = "<text x=\"818.0\" y=\"";
  for (std::size_t at = 0; (at = svg.find(kLabel, at)) != std::string::npos; ++at)
    heights.push_back(std::stod(svg.substr(at + kLabel.size())));
  std::sort(heights.begin(), heights.end());
  return heights;
}

TEST(OverdrawChart, LabelsDoNotOverlap) {
  // Nine names in one place: at the top, in the middle, at the bottom. Finally more names than fit.
  for (const auto& [value, count] : {std::pair{1.5, 9}, {1.25, 9}, {1.0, 9}, {1.25, 30}}) {
    std::vector<OverdrawRow> rows{row("low", {1, 1}), row("high", {1.5, 1.5})};
    for (int i = 0; i < count; ++i) rows.push_back(row("m" + std::to_string(i), {value, value}));
    const std::vector<double> heights = label_heights(overdraw_chart(report_of({2}, rows)));
    ASSERT_EQ(heights.size(), rows.size());
    const double gap = count == 9 ? 16.9 : 240.0 / 31 - 0.11;
    for (std::size_t i = 1; i < heights.size(); ++i)
      EXPECT_GE(heights[i] - heights[i - 1], gap) << value << ' ' << i;
    EXPECT_GE(heights.front(), 63.9) << value;
    EXPECT_LE(heights.back(), 304.1) << value;
  }
}

TEST(OverdrawChart, DrawsBarsForAStaticMesh) {
  OverdrawReport report = report_of({}, {row("refined", {1.1}), row("meshopt", {1.5}), row("blind", {0})});
  report.frames = {{}};
  const std::string svg = overdraw_chart(report);
  EXPECT_EQ(svg.find("<polyline"), std::string::npos);
  // 650 pixels from 1 to 1.5.
  EXPECT_NE(svg.find("x=\"150.0\" y=\"50.0\" width=\"130.0\""), std::string::npos);
  EXPECT_NE(svg.find("x=\"150.0\" y=\"80.0\" width=\"650.0\""), std::string::npos);
  EXPECT_NE(svg.find(">nothing seen<"), std::string::npos);
  EXPECT_EQ(testing::first_nesting_error(svg, "<svg"), "");
}

TEST(OverdrawChart, TakesEmptyAndShortRows) {
  EXPECT_NE(overdraw_chart({}).find("Nothing was measured."), std::string::npos);
  OverdrawReport report = report_of({3}, {row("a", {}), row("b", {1.5, 1.5}), row("c", {1, 1, 1})});
  report.frames.resize(1);
  report.clips.clear();
  const std::string svg = overdraw_chart(report);
  EXPECT_EQ(testing::first_nesting_error(svg, "<svg"), "");
  EXPECT_TRUE(curve_points(svg, "a").empty());
  EXPECT_EQ(count_of(curve_points(svg, "b").at(0), ","), 2U);
  EXPECT_EQ(count_of(curve_points(svg, "c").at(0), ","), 3U);
  EXPECT_NE(svg.find(">clip 0<"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(OverdrawChart, EscapesAndCutsNames) {
  OverdrawReport report = report_of({1, 1}, {row("<script>\"'&", {1.5, 1.25})});
  report.clips[0].name = "\" onload=\"<script>";
  report.clips[1].name.clear();
  for (int i = 0; i < 100; ++i) report.clips[1].name += "\u00e9";
  const std::string svg = overdraw_chart(report);
  EXPECT_EQ(testing::first_nesting_error(svg, "<svg"), "");
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_EQ(svg.find("\" onload"), std::string::npos);
  EXPECT_NE(svg.find("&lt;script&gt;&quot;&#39;&amp; 1.375"), std::string::npos);
  EXPECT_NE(svg.find("\u00e9\u00e9\u2026<"), std::string::npos);
}

// ----------------------------------------------------------------------------------------------------- page

const std::vector<std::vector<HeatMap>> kSheet{
    {map_of(1, {1}, "refined: 1.000"), map_of(1, {2}, "refined: 2.000")}, {map_of(1, {3}, "paper: 3.000")}};

TEST(OverdrawHtml, ShowsTheNumbers) {
  OverdrawReport report =
      report_of({2, 2}, {row("refined", {1.1, 1.1, 1.1, 1.1}), row("paper", {1.25, 1.25, 1.25, 1.25}),
                         row("input", {1.5, 1.5})});
  report.rows[0].buffers = 5;
  report.rows[0].between = OverdrawQuality{"refined", 1.125, 1.75, {}};
  report.notes = {"a note"};
  report.views = 648;
  const std::string page = overdraw_html(report, kSheet);
  EXPECT_EQ(testing::first_nesting_error(page, "<html"), "");
  const std::string ours =
      "<tr class=\"ours\"><td>refined</td><td>5</td><td>0.850</td><td>1.100</td><td>0.100</td><td>40 %</td>"
      "<td>1.350</td><td>1.125</td><td>1.750</td></tr>";
  EXPECT_NE(page.find(ours), std::string::npos);
  for (const char* text :
       {"<td>1.500</td><td>0.500</td><td>200 %</td>", "knight.glb: 5 index buffers", "12,996 triangles",
        "4 key frames", "648", "a note", "<figcaption>paper: 3.000</figcaption>", "repeat(2,", "#dae4ef"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  EXPECT_EQ(count_of(page, "<figure>"), 3U);
  EXPECT_EQ(count_of(page, "<polyline"), 2 + 2 + 1U);
}

TEST(OverdrawHtml, ComparesWithMeshoptimizerWithoutThePaper) {
  std::string page =
      overdraw_html(report_of({2}, {row("refined", {1.1, 1.1}), row("meshopt", {1.2, 1.2})}), {});
  EXPECT_NE(page.find("of meshopt</th>"), std::string::npos);
  EXPECT_NE(page.find("<td>50 %</td>"), std::string::npos);
  EXPECT_EQ(page.find("between"), std::string::npos);
  page = overdraw_html(report_of({2}, {row("refined", {1.1, 1.1})}), {});
  EXPECT_EQ(page.find("of the excess"), std::string::npos);
  page = overdraw_html(report_of({2}, {row("refined", {1, 1}), row("paper", {1, 1})}), {});
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(page.find("inf"), std::string::npos);
}

TEST(OverdrawHtml, TakesEmptyAndStaticReports) {
  std::string page = overdraw_html({}, {});
  EXPECT_EQ(testing::first_nesting_error(page, "<html"), "");
  EXPECT_NE(page.find("Nothing was measured."), std::string::npos);
  OverdrawReport report = report_of({}, {row("refined", {1.1})});
  report.frames = {{}};
  page = overdraw_html(report, {{}, {map_of(0, {})}});
  EXPECT_EQ(testing::first_nesting_error(page, "<html"), "");
  EXPECT_EQ(page.find("<polyline"), std::string::npos);
  EXPECT_EQ(page.find("<figure"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST(OverdrawHtml, IsWellFormedWithHostileNames) {
  const std::string evil = "</title><script>alert(\"1\")</script>&'";
  OverdrawReport report = report_of({1, 1}, {row(evil, {1.5, 1.25})});
  report.input = report.output = report.method = report.clips[0].name = evil;
  report.notes = report.files = {evil};
  const std::string page = overdraw_html(report, {{map_of(1, {1}, evil)}});
  EXPECT_EQ(testing::first_nesting_error(page, "<html"), "");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("(\"1\")"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
}

TEST(OverdrawHtml, FetchesNothing) {
  const std::string page =
      overdraw_html(report_of({2}, {row("refined", {1.1, 1.1}), row("paper", {1.2, 1.2})}), kSheet);
  for (const char* text : {"http", "url(", "@import", "<link", "href", "<script"})
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  EXPECT_EQ(count_of(page, "src=\""), 3U);
  EXPECT_EQ(count_of(page, "src=\"data:image/png;base64,"), 3U);
}

}  // namespace
}  // namespace pellucid
