// Inline SVG for the report page: spheres of view directions and plots of the error.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pellucid/metric.h"
#include "pellucid/sequencing.h"
#include "pellucid/view.h"

namespace pellucid {

// Two hemispheres of view cells, coloured by the order that they use.
std::string order_sphere_svg(const OrderSet& orders);

// Two hemispheres of view directions, coloured by the share of wrong pixels near each; dots are the
// viewpoints.
std::string error_sphere_svg(std::span<const Viewpoint> viewpoints, std::span<const FrameError> frames);

// Wrong pixels of every viewpoint over its distance, and the mean of each distance bin as steps.
std::string distance_plot_svg(std::span<const Viewpoint> viewpoints, std::span<const FrameError> frames,
                              std::span<const DistanceError> bins, double nearest, double farthest);

// How many viewpoints have how many wrong pixels.
std::string histogram_svg(std::span<const FrameError> frames);

// How many pixels have how many fragments; pixels_by_depth[n] have n. Those without any are left out.
std::string depth_histogram_svg(std::span<const std::uint64_t> pixels_by_depth);

}  // namespace pellucid
