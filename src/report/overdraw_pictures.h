// The pictures of an overdraw report one by one, for its page and its files.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "pellucid/metric.h"
#include "pellucid/overdraw_report.h"

namespace pellucid {

using Rgb = std::array<std::uint8_t, 3>;

// Fragments in vain that the colours tell apart: 0, 1, 2, 3, and 4 or more.
constexpr std::uint32_t kHeatSteps = 5;

// Of a pixel that so many fragments were shaded for: white for none, then darker with each one in vain.
Rgb heat_color(std::uint32_t shaded);
// Between these colours but the white one, so that small differences show; `share` of 0 to 1.
Rgb heat_between(double share);

// Throws Error{bad_argument} when `map` has not size * size pixels.
Image heat_picture(const HeatMap& map);

// Key frames along the axis of the chart: those of the longest row. Up to one, the chart has bars.
std::size_t charted_frames(const OverdrawReport& report);

// overdraw_chart() for a file of its own, or as an element of a page, where a namespace is not needed.
enum class ChartPlace { file, page };
std::string overdraw_chart_for(const OverdrawReport& report, ChartPlace place);

}  // namespace pellucid
