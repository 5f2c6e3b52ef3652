// Tests numbers and tables as plain text.
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "handmade.h"
#include "pellucid/report.h"

namespace pellucid {
namespace {

TEST(Text, CountsHaveThousandsSeparators) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1000), "1,000");
  EXPECT_EQ(format_count(1234567), "1,234,567");
  EXPECT_EQ(format_count(std::numeric_limits<std::uint64_t>::max()), "18,446,744,073,709,551,615");
}

TEST(Text, BytesHaveDecimalUnits) {
  EXPECT_EQ(format_bytes(999), "999 B");
  EXPECT_EQ(format_bytes(1500), "1.5 KB");
  EXPECT_EQ(format_bytes(2'500'000), "2.5 MB");
  EXPECT_EQ(format_bytes(3'250'000'000), "3.25 GB");
}

TEST(Text, SecondsBecomeMinutes) {
  EXPECT_EQ(format_seconds(0.0421), "0.042 s");
  EXPECT_EQ(format_seconds(12.34), "12.3 s");
  EXPECT_EQ(format_seconds(245), "4 min 05 s");
  EXPECT_EQ(format_seconds(std::numeric_limits<double>::quiet_NaN()), "-");
}

TEST(Text, NanosecondsFindTheirUnit) {
  EXPECT_EQ(format_nanoseconds(0), "0 ns");
  EXPECT_EQ(format_nanoseconds(87.4), "87 ns");
  EXPECT_EQ(format_nanoseconds(12345), "12.3 us");
  EXPECT_EQ(format_nanoseconds(4.56e6), "4.56 ms");
  EXPECT_EQ(format_nanoseconds(std::numeric_limits<double>::infinity()), "-");
}

TEST(Text, TheMeasureTableFitsATerminal) {
  MeasureReport report = testing::measured("quad");
  MethodReport wide = testing::method("cache_optimized", MethodKind::baseline, 0.000123);
  wide.buffers = 16;
  wide.memory_bytes = 999'900;
  wide.fifo = {4, 8, 2.987, 2.987};
  wide.overdraw = 12.345;
  wide.build_seconds = 245;
  wide.nanoseconds_per_frame = 123456;
  wide.quality.psnr_mean = 100;
  report.primitives[0].methods.push_back(wide);
  report.primitives[0].notes = {"bsp: left out"};
  const std::string text = to_text(report);
  EXPECT_NE(text.find("\nbsp: left out\n"), std::string::npos);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120U) << line;
}

TEST(Text, SmallPercentagesKeepTheirDigits) {
  EXPECT_EQ(format_percent(0), "0 %");
  EXPECT_EQ(format_percent(0.00012), "0.0120 %");
  EXPECT_EQ(format_percent(0.0123), "1.23 %");
  EXPECT_EQ(format_percent(std::numeric_limits<double>::infinity()), "-");
}

TEST(Text, TableAlignsByDisplayWidth) {
  TextTable table({"name", "count"});
  table.add_row({"Gl\u00e4ser", "5"});  // six columns, seven bytes
  table.add_row({"x", "12,345"});
  EXPECT_EQ(table.to_string(),
            "name     count\n"
            "Gl\u00e4ser       5\n"
            "x       12,345\n");
}

}  // namespace
}  // namespace pellucid
