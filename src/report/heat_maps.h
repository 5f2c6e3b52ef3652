// Computes the colours of heat maps: of overdraw, and of any value between zero and the largest. In: counts
// or shares. Out: colours and images.
#pragma once

#include <array>
#include <cstdint>

#include "pellucid/base.h"
#include "pellucid/overdraw_report.h"

namespace pellucid {

using Rgb = std::array<std::uint8_t, 3>;

// The number of colours for wasted fragments: 0, 1, 2, 3, and 4 or more.
constexpr std::uint32_t kHeatSteps = 5;

// Returns the colour of a pixel for which `shaded` fragments were shaded: white for none, then darker with
// each wasted fragment.
Rgb heat_color(std::uint32_t shaded);
// Returns a colour for a share from 0 to 1, between those of heat_color() without the white.
Rgb heat_between(double share);

// Returns a heat map as an image. Throws Error{bad_argument} if `map` does not have size * size pixels.
Image heat_image(const HeatMap& map);

}  // namespace pellucid
