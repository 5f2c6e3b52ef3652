// read_back.h - copies what a frame left on the device into a RenderResult: the colours of an image or band,
// and the fragments of every pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/frame.h"

namespace pellucid::render {

constexpr std::size_t kDumpWords = 3;  // words of a fragment: dump_write() of shaders/resolve/effects.glsl

// Appends the colours of a band to those of `result`, and averages the samples of a pixel.
void read_colors(const Buffer& final_colors, const Frame& frame, RenderResult& result);
// Appends the fragments that kDumpEffect wrote. `offsets` has the first fragment of every pixel and sample of
// the band, and the end. With `colored`, their colours are appended, too.
void read_fragments(const Buffer& dump, const Frame& frame, const std::vector<std::uint32_t>& offsets,
                    bool colored, RenderResult& result);

}  // namespace pellucid::render
