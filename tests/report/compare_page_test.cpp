// Tests the page of a comparison: its markup, its plots, and its script in a browser.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "browser.h"
#include "comparison.h"
#include "markup.h"
#include "pellucid/material.h"
#include "report/technique_charts.h"

namespace pellucid {
namespace {

using testing::first_nesting_error;
using testing::occurrences;
using testing::sample_comparison;

// ------------------------------------------------------------------------------------------------ the markup

TEST(ComparePage, IsWellFormedWithHostileNames) {
  CompareReport report = sample_comparison("</td><img src=x>\"&'");
  report.scenes.push_back(report.scenes.front());
  const std::string page = compare_html(report);
  EXPECT_EQ(first_nesting_error(page, "<html"), "");
  EXPECT_EQ(page.find("<img src=x>"), std::string::npos);
  EXPECT_EQ(first_nesting_error(compare_html(CompareReport{}), "<html"), "");
}

TEST(ComparePage, FetchesNothing) {
  const std::string page = compare_html(sample_comparison());
  for (const char* text : {"http", "url(", "@import", "<link", "script src", "import(", "fetch("})
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  EXPECT_EQ(occurrences(page, "href=\""), occurrences(page, "href=\"#"));
  EXPECT_EQ(occurrences(page, "src=\""), occurrences(page, "src=\"data:image/png;base64,"));
  EXPECT_EQ(occurrences(page, "src=\""), 3U);
}

TEST(ComparePage, WarnsOfDriversOnTheCpu) {
  CompareReport report = sample_comparison();
  EXPECT_EQ(compare_html(report).find("runs on the CPU"), std::string::npos);
  report.device.cpu = true;
  EXPECT_NE(compare_html(report).find("runs on the CPU"), std::string::npos);
}

TEST(ComparePage, ShowsTheImagesThatDifferWithoutAScript) {
  const std::string page = compare_html(sample_comparison());
  EXPECT_EQ(occurrences(page, "name=\"pictures0\""), 2U);
  EXPECT_EQ(occurrences(page, "<div class=\"viewer\" hidden=\"hidden\">"), 1U);
  EXPECT_NE(page.find("exact picture: f2b-2p, ll, sb."), std::string::npos);
  EXPECT_NE(page.find("<td colspan=\"16\">stack needs 64-bit atomics</td>"), std::string::npos);
}

TEST(ComparePage, EmbedsAnImageOnce) {
  CompareReport report = sample_comparison();
  ComparedTechnique equal = report.scenes[0].techniques[0];
  equal.name = "dual";
  report.scenes[0].techniques.push_back(equal);
  const std::string page = compare_html(report);
  EXPECT_EQ(occurrences(page, "src=\""), 3U);
  EXPECT_NE(page.find(">f2b, dual</label>"), std::string::npos);
  EXPECT_EQ(occurrences(page, "<option value=\"p1\""), 4U);  // both names in both menus
}

TEST(ComparePage, HasAMatrixOfSeveralScenes) {
  CompareReport report = sample_comparison();
  EXPECT_EQ(compare_html(report).find("id=\"overview\""), std::string::npos);
  report.scenes.push_back(report.scenes.front());
  report.scenes[1].input = "dir/other.glb";
  report.scenes[1].techniques[1].stats.milliseconds = 32;  // 8 times the fastest; 2 in the first scene
  const std::string page = compare_html(report);
  EXPECT_NE(page.find("id=\"overview\""), std::string::npos);
  EXPECT_EQ(occurrences(page, "<a href=\"#scene-1\">other.glb</a>"), 4U);  // contents, time, error, memory
  const std::vector<TechniqueSummary> all = summarize(report);
  ASSERT_EQ(all.size(), 5U);
  EXPECT_NEAR(all[1].time_ratio.value(), 4, 1e-9);
  EXPECT_EQ(all[0].worst_psnr, 23.5);
  EXPECT_EQ(all[0].equal, 0U);
  EXPECT_EQ(all[1].equal, 2U);
  EXPECT_EQ(all[4].drawn, 0U);
  EXPECT_EQ(all[4].time_ratio, std::nullopt);
}

TEST(ComparePage, HeatMapsHaveScalesWithNumbers) {
  CompareReport report = sample_comparison();
  report.scenes[0].maps = {{"fragments", "fragments of a pixel", "fragments", 12, {8, 9}}};
  const std::string page = compare_html(report);
  EXPECT_NE(page.find("data-most=\"12\" data-unit=\"fragments\""), std::string::npos);
  // The steps are 5; the step at 10 is left out, as it would meet the end at 12.
  EXPECT_NE(page.find("<span style=\"left:41.7%\">5</span><span style=\"left:100.0%\">12</span>"),
            std::string::npos);
  EXPECT_NE(page.find("<option value=\"m0\""), std::string::npos);
}

// ------------------------------------------------------------------------------------------------- the plots

TEST(LabelPlaces, DoNotOverlap) {
  std::vector<LabelPoint> points;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 6; ++column)
      points.push_back({200.0 + 9 * column, 100.0 + 7 * row, "technique-" + std::to_string(points.size())});
  }
  const LabelBox area{0, 0, 900, 400};
  const std::vector<PlacedLabel> labels = place_labels(points, area);
  ASSERT_EQ(labels.size(), points.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_TRUE(area.holds(labels[i].box)) << i;
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(labels[i].box.meets(labels[j].box)) << i << " " << j;
  }
}

TEST(TechniqueCharts, PutTechniquesThatEqualTheExactImageOnALineAboveErrors) {
  CostChart chart;
  chart.x_text = [](double) { return ""; };
  chart.points = {
      {"a", "", true, true, 1, 0}, {"b", "", false, false, 1, 20}, {"c", "", false, false, 10, 30}};
  const std::string svg = cost_chart_svg(chart);
  EXPECT_EQ(first_nesting_error(svg, "<svg"), "");
  EXPECT_NE(svg.find("<circle cx=\"70.0\" cy=\"136.0\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("<circle cx=\"70.0\" cy=\"396.0\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("<circle cx=\"920.0\" cy=\"166.0\""), std::string::npos) << svg;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(TechniqueCharts, CutBarsThatWouldHideAllOthers) {
  const BarChart chart{"t", {"a", "b", "c"}, {true, true, false}, {{"ms", {1, 1, 600}, {"1", "1", "600"}}}};
  const std::string svg = bar_chart_svg(chart);
  EXPECT_EQ(first_nesting_error(svg, "<svg"), "");
  EXPECT_EQ(occurrences(svg, "<path"), 1U);
  EXPECT_NE(svg.find(">600<"), std::string::npos);
}

// ---------------------------------------------------------------------------------------------- in a browser

constexpr std::array<std::uint8_t, 3> kExactColor{200, 40, 90};
constexpr std::array<std::uint8_t, 3> kOtherColor{30, 160, 220};

std::vector<std::uint8_t> png_of(const std::array<std::uint8_t, 3>& color, std::uint32_t width,
                                 std::uint32_t height) {
  Image image{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i)
    image.rgb.insert(image.rgb.end(), color.begin(), color.end());
  return encode_png(image);
}

// Every image has one colour.
CompareReport report_of_colors() {
  CompareReport report = sample_comparison();
  ComparedScene& scene = report.scenes[0];
  scene.image.png = png_of(kExactColor, scene.width, scene.height);
  scene.techniques[0].images = {{"f2b", png_of(kOtherColor, scene.width, scene.height)},
                                {"difference", png_of({140, 10, 40}, scene.width, scene.height)}};
  scene.maps = {{"fragments", "fragments of a pixel", "fragments", 8,
                 png_of({68, 16, 24}, scene.width, scene.height)}};  // the darkest of the scale
  return report;
}

// Runs before the page's script, and collects its errors. Synthetic events have no pointer to capture.
constexpr const char* kWatch = R"(<script>
const complaints = [];
addEventListener('error', (event) => complaints.push(event.message));
addEventListener('unhandledrejection', (event) => complaints.push(String(event.reason)));
console.error = (...all) => complaints.push(all.join(' '));
Element.prototype.setPointerCapture = () => {};
</script>)";

// Runs after the page's script: uses the viewer as a reader would, and writes what it saw into the page.
constexpr const char* kProbe = R"(<pre id="probe"></pre><script>
addEventListener('load', () => {
  const seen = {};
  const viewer = document.querySelector('.viewer');
  const find = (name) => viewer.querySelector(name);
  const stage = find('.stage');
  const color = (share) => {
    const canvas = find('canvas');
    const place = [Math.floor(share * canvas.width), canvas.height >> 1];
    return [...canvas.getContext('2d').getImageData(...place, 1, 1).data].slice(0, 3).join(' ');
  };
  const sides = () => [color(0.1), color(0.4), color(0.6), color(0.9)];
  const key = (target, key, type = 'keydown') => target.dispatchEvent(new KeyboardEvent(type, {key, bubbles: true}));
  const pointer = (target, type, x, y) => {
    const box = stage.getBoundingClientRect();
    target.dispatchEvent(new PointerEvent(type, {pointerId: 1, button: 0, bubbles: true,
      clientX: box.left + x * box.width, clientY: box.top + y * box.height}));
  };
  const mode = (name) => find(`input[value="${name}"]`).click();
  const choose = (name, words) => {
    const menu = find(`select.${name}`);
    menu.selectedIndex = [...menu.options].findIndex((option) => option.text === words);
    menu.dispatchEvent(new Event('change'));
  };

  seen.shown = [viewer.hidden, viewer.parentElement.querySelector('.flip').hidden];
  seen.menus = ['left', 'right'].map((name) => find(`select.${name}`).selectedOptions[0].text);
  seen.start = sides();
  key(find('.divider'), 'ArrowLeft');
  seen.arrow = find('.divider').getAttribute('aria-valuenow');
  key(find('.divider'), 'Home');
  seen.home = sides();
  pointer(find('.divider'), 'pointerdown', 0, 0.5);
  pointer(stage, 'pointermove', 0.75, 0.5);
  pointer(stage, 'pointerup', 0.75, 0.5);
  seen.dragged = sides();
  seen.readout = find('.readout').innerText.replace(/\s+/g, ' ');
  mode('flip');
  seen.flip = color(0.9);
  key(stage, ' ');
  seen.held = color(0.1);
  key(stage, ' ', 'keyup');
  seen.released = color(0.9);
  pointer(stage, 'pointerdown', 0.5, 0.5);
  seen.pressed = color(0.1);
  mode('swipe');  // while it is held
  pointer(stage, 'pointerup', 0.5, 0.5);
  mode('flip');
  seen.left = color(0.1);
  find('select.gain').value = '1';
  find('select.gain').dispatchEvent(new Event('change'));
  mode('difference');
  seen.difference = color(0.5);
  mode('swipe');
  const before = parseInt(find('output').textContent);
  find('button[value="in"]').click();
  seen.zoomed = parseInt(find('output').textContent) > before;
  find('button[value="fit"]').click();
  seen.fitted = parseInt(find('output').textContent) === before;
  find('button.swap').click();
  seen.swapped = sides();
  choose('right', 'fragments');
  pointer(stage, 'pointermove', 0.5, 0.5);
  seen.map = find('.readout').innerText.replace(/\s+/g, ' ');
  choose('left', 'fragments');
  seen.legends = viewer.querySelectorAll('.legends .legend').length;
  const names = () => [...document.querySelectorAll('section tbody tr')].map((row) => row.cells[0].textContent);
  const time = document.querySelectorAll('section thead th button')[2];
  seen.order = names();
  time.click();
  seen.rising = names();
  time.click();
  seen.falling = names();
  seen.complaints = complaints;
  document.getElementById('probe').textContent = JSON.stringify(seen);
});
</script>)";

std::string text_of(const std::array<std::uint8_t, 3>& color) {
  return std::to_string(color[0]) + " " + std::to_string(color[1]) + " " + std::to_string(color[2]);
}

class ComparePageInBrowser : public ::testing::Test {
 protected:
  void SetUp() override {
    browser_ = testing::find_browser().value_or("");
    if (browser_.empty()) GTEST_SKIP() << "no chromium, chromium-browser or google-chrome is installed";
    folder_ = std::filesystem::temp_directory_path() / ("pellucid-page-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }

  std::optional<std::string> open(const std::string& action, const std::string& page) {
    const std::filesystem::path file = folder_ / "page.html";
    std::ofstream(file) << page;
    return testing::open_page(browser_, action, file, folder_ / "browser");
  }

  std::string browser_;
  std::filesystem::path folder_;
};

TEST_F(ComparePageInBrowser, LaysTwoImagesOverEachOther) {
  std::string page = compare_html(report_of_colors());
  page.insert(page.find("<main>"), kWatch);
  page.insert(page.find("</main>"), kProbe);
  const std::optional<std::string> dom = open("--dump-dom", page);
  ASSERT_TRUE(dom);
  const std::size_t at = dom->find("<pre id=\"probe\">{");
  ASSERT_NE(at, std::string::npos) << "the page's script did not come to its end";
  const std::size_t begin = at + 16;
  const nlohmann::json seen = nlohmann::json::parse(dom->substr(begin, dom->find("</pre>", begin) - begin));
  EXPECT_EQ(seen["complaints"], nlohmann::json::array());

  const std::string a = text_of(kExactColor);
  const std::string b = text_of(kOtherColor);
  using List = nlohmann::json;
  EXPECT_EQ(seen["shown"], (List{false, true}));
  EXPECT_EQ(seen["menus"], (List{"exact", "f2b"}));
  EXPECT_EQ(seen["start"], (List{a, a, b, b}));
  EXPECT_EQ(seen["arrow"], "49");
  EXPECT_EQ(seen["home"], (List{b, b, b, b}));
  EXPECT_EQ(seen["dragged"], (List{a, a, a, b}));
  EXPECT_EQ(seen["readout"], "(30, 10) exact " + a + " f2b " + b + " difference 170 120 130 of 255");
  EXPECT_EQ(seen["flip"], a);
  EXPECT_EQ(seen["held"], b);
  EXPECT_EQ(seen["released"], a);
  EXPECT_EQ(seen["pressed"], b);
  EXPECT_EQ(seen["left"], a);
  EXPECT_EQ(seen["difference"], "170 120 130");
  EXPECT_EQ(seen["zoomed"], true);
  EXPECT_EQ(seen["fitted"], true);
  EXPECT_EQ(seen["swapped"], (List{b, b, b, a}));
  EXPECT_NE(seen["map"].get<std::string>().find("fragments 8 fragments"), std::string::npos) << seen["map"];
  EXPECT_EQ(seen["legends"], 1);
  // By time; what failed has none.
  EXPECT_EQ(seen["order"], (List{"f2b", "f2b-2p", "ll", "sb", "kb"}));
  EXPECT_EQ(seen["rising"], (List{"f2b", "sb", "ll", "f2b-2p", "kb"}));
  EXPECT_EQ(seen["falling"], (List{"f2b-2p", "ll", "sb", "f2b", "kb"}));
}

// The screen shows the exact image only on the left of the divider, and the other image on its right.
TEST_F(ComparePageInBrowser, ShowsThemOnTheScreen) {
  const std::filesystem::path file = folder_ / "screen.png";
  ASSERT_TRUE(open("--screenshot='" + file.string() + "'", compare_html(report_of_colors())));
  const RgbaImage screen = read_image(file.string());
  ASSERT_GT(std::size_t{screen.width} * screen.height, 0U);
  struct Seen {
    std::size_t pixels = 0;
    std::uint32_t first = UINT32_MAX, last = 0;  // columns
  };
  const auto find = [&](const std::array<std::uint8_t, 3>& color) {
    Seen seen;
    for (std::uint32_t p = 0; p < screen.width * screen.height; ++p) {
      if (!std::equal(color.begin(), color.end(), screen.rgba.begin() + std::ptrdiff_t{4} * p)) continue;
      ++seen.pixels;
      seen.first = std::min(seen.first, p % screen.width);
      seen.last = std::max(seen.last, p % screen.width);
    }
    return seen;
  };
  const Seen exact = find(kExactColor);
  const Seen other = find(kOtherColor);
  EXPECT_GT(exact.pixels, 10'000U);
  EXPECT_GT(other.pixels, 10'000U);
  EXPECT_LT(exact.last, other.first);
  EXPECT_LT(other.first - exact.last, 10U);
}

}  // namespace
}  // namespace pellucid
