// The report page is well formed, safe and self-contained.
#include <gtest/gtest.h>

#include <cctype>
#include <vector>

#include "pellucid/report.h"
#include "report/handmade.h"

namespace pellucid {
namespace {

std::string page_of(const MeasureReport& measured, const OrderSet& orders, const std::string& title) {
  const std::vector<PictureRow> rows{{"row " + title, {{"caption " + title, {1, 2, 3, 4}}}}};
  HtmlReportInput input;
  input.title = title;
  input.measured = &measured;
  input.orders = &orders;
  input.rows = rows;
  input.command = "pellucid measure " + title;
  return html_report(input);
}

// The open element that a wrong end tag meets, "" when tags nest properly. void elements must be closed as in
// XML.
std::string first_nesting_error(const std::string& page) {
  std::vector<std::string> open;
  std::size_t at = page.find("<html");
  while ((at = page.find('<', at)) != std::string::npos) {
    const bool end_tag = page[at + 1] == '/';
    std::size_t name_end = at + (end_tag ? 2 : 1);
    while (std::isalnum(static_cast<unsigned char>(page[name_end])) != 0) ++name_end;
    const std::string name = page.substr(at + (end_tag ? 2 : 1), name_end - at - (end_tag ? 2 : 1));
    const std::size_t close = page.find('>', at);
    if (close == std::string::npos) return "unclosed tag " + name;
    if (end_tag) {
      if (open.empty() || open.back() != name) return "</" + name + "> at " + page.substr(at, 60);
      open.pop_back();
    } else if (page[close - 1] != '/') {
      open.push_back(name);
      if (name == "style") at = page.find("</style", at) - 1;
    }
    ++at;
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

TEST(Html, EscapesEverythingThatCanBreakOut) {
  EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(Html, IsWellFormedWithHostileNames) {
  const std::string evil = "</title><script>alert(\"1\")</script>&'";
  const std::string page = page_of(testing::measured(evil), testing::two_orders(), evil);
  EXPECT_EQ(first_nesting_error(page), "");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
}

TEST(Html, TheNestingCheckCanFail) {
  EXPECT_NE(first_nesting_error("<html><p></html>"), "");
  EXPECT_NE(first_nesting_error("<html><br></html>"), "");
  EXPECT_EQ(first_nesting_error("<html><br/><p>x</p></html>"), "");
}

TEST(Html, FetchesNothing) {
  const std::string page = page_of(testing::measured("quad"), testing::two_orders(), "quad");
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("url("), std::string::npos);
  EXPECT_EQ(page.find("@import"), std::string::npos);
  EXPECT_EQ(page.find("<link"), std::string::npos);
  for (std::size_t at = 0; (at = page.find("src=\"", at)) != std::string::npos; ++at) {
    EXPECT_EQ(page.compare(at, 27, "src=\"data:image/png;base64,"), 0);
  }
  EXPECT_NE(page.find("base64,AQIDBA=="), std::string::npos);
}

TEST(Html, ShowsEveryMethodAndFollowsTheColourScheme) {
  const std::string page = page_of(testing::measured("quad"), testing::two_orders(), "quad");
  for (const char* text :
       {"original order", "centroid sort", "25.00 %", "prefers-color-scheme", "S0,0, 20 cells"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
}

TEST(Html, DrawsViewpointCellsAndFramesWithoutError) {
  MeasureReport report = testing::measured("quad");
  for (FrameError& frame : report.primitives[0].methods[0].quality.frames) frame.incorrect = 0;
  OrderSet orders = testing::two_orders();
  orders.partition = parse_partition("P1");
  orders.cell_orders.assign(42, 1);
  const std::string page = page_of(report, orders, "quad");
  EXPECT_EQ(first_nesting_error(page), "");
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_NE(page.find("order 1: 42 cells"), std::string::npos);
}

}  // namespace
}  // namespace pellucid
