// Tests that the page of a measurement is well formed, safe and self-contained.
#include <gtest/gtest.h>

#include <vector>

#include "handmade.h"
#include "markup.h"
#include "pellucid/report.h"

namespace pellucid {
namespace {

std::string page_of(const MeasureReport& measured, const OrderSet& orders, const std::string& title) {
  const std::vector<ImageRow> rows{{"row " + title, {{"caption " + title, {1, 2, 3, 4}}}}};
  HtmlReportInput input;
  input.title = title;
  input.measured = &measured;
  input.orders = &orders;
  input.rows = rows;
  input.command = "pellucid measure " + title;
  return html_report(input);
}

TEST(Html, EscapesEverythingThatCanBreakOut) {
  EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(Html, IsWellFormedWithHostileNames) {
  const std::string evil = "</title><script>alert(\"1\")</script>&'";
  const std::string page = page_of(testing::measured(evil), testing::two_orders(), evil);
  EXPECT_EQ(testing::first_nesting_error(page, "<html"), "");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
}

TEST(Html, TheNestingCheckCanFail) {
  EXPECT_NE(testing::first_nesting_error("<html><p></html>", "<html"), "");
  EXPECT_NE(testing::first_nesting_error("<html><br></html>", "<html"), "");
  EXPECT_EQ(testing::first_nesting_error("<html><br/><p>x</p></html>", "<html"), "");
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
  EXPECT_EQ(testing::first_nesting_error(page, "<html"), "");
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_NE(page.find("order 1: 42 cells"), std::string::npos);
}

}  // namespace
}  // namespace pellucid
