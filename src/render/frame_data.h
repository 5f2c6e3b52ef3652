// frame_data.h - what shaders know of a frame.
#pragma once

#include <array>
#include <cstdint>

#include "render/frame.h"

namespace pellucid::render {

// shaders/interface/frame.glsl, std430
struct FrameData {
  std::array<float, 16> clip_from_world{};
  std::array<float, 4> eye{}, to_viewer{}, fill_light{}, background{}, planes{};
  std::array<std::uint32_t, 2> size{};
  std::uint32_t objects = 0, capacity = 0;
  std::array<float, 4> line{};
  std::uint32_t first_row = 0, csg = 0, samples = 1, unused = 0;
};
static_assert(sizeof(FrameData) == 192);

FrameData frame_data(const Camera& camera, const Frame& frame);

}  // namespace pellucid::render
