// color_sums.h - what fragments leave in a pixel without an order: sums that blending adds up, and a picture
// of their mean.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// Of colours and opacity, weighted in some way: half floats, as published.
constexpr VkFormat kColorSums = VK_FORMAT_R16G16B16A16_SFLOAT;
// Of optical depths: what all fragments together let through is exact.
constexpr VkFormat kDepthSums = VK_FORMAT_R32_SFLOAT;

// One geometry pass: everything that `fragment_shader` writes to its outputs is added up in `targets`, which
// start with 0.
void draw_sums(const Frame& frame, Recorder& recorder, std::string_view fragment_shader,
               const Constants& constants, const std::vector<const Image*>& targets);
// Leaves the picture.
void resolve_sums(const Frame& frame, Recorder& recorder, const Image& colors, const Image& depths);

}  // namespace pellucid::render
