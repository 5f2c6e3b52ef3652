// Draws charts of measured orders as inline SVG: spheres of view directions, plots and histograms. In:
// orders, viewpoints and their errors. Out: SVG for a page with the style of html_page.h.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pellucid/metric.h"
#include "pellucid/sequencing.h"
#include "pellucid/view.h"

namespace pellucid {

// Returns two hemispheres of view cells, coloured by the order that each cell uses.
std::string order_sphere_svg(const OrderSet& orders);

// Returns two hemispheres of view directions, coloured by the share of wrong pixels near each direction. Dots
// are the viewpoints.
std::string error_sphere_svg(std::span<const Viewpoint> viewpoints, std::span<const FrameError> frames);

// Returns a plot of the wrong pixels of every viewpoint over its distance, with the mean of each range of
// distances as steps.
std::string distance_plot_svg(std::span<const Viewpoint> viewpoints, std::span<const FrameError> frames,
                              std::span<const DistanceError> bins, double nearest, double farthest);

// Returns a histogram of viewpoints by their share of wrong pixels.
std::string histogram_svg(std::span<const FrameError> frames);

// Returns a histogram of pixels by their number of fragments: pixels_by_depth[n] pixels have n. Pixels
// without fragments are left out.
std::string depth_histogram_svg(std::span<const std::uint64_t> pixels_by_depth);

}  // namespace pellucid
