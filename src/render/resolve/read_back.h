// read_back.h - copies what a frame left on the device into a RenderResult: colours of an image or a band,
// and the fragments of every pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/frame.h"

namespace pellucid::render {

constexpr std::size_t kDumpWords = 3;  // words of a fragment: dump_write() of shaders/resolve/effects.glsl

// Appends the colours of a band to those that `result` has, with the samples of a pixel averaged.
void read_colors(const Buffer& final_colors, const Frame& frame, RenderResult& result);
// Appends the fragments that kDumpEffect wrote. `offsets` has the first one of every pixel and sample of the
// band, and the end. `colored`: with their colours.
void read_fragments(const Buffer& dump, const Frame& frame, const std::vector<std::uint32_t>& offsets,
                    bool colored, RenderResult& result);

}  // namespace pellucid::render
