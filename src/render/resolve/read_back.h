// read_back.h - what a frame left on the device, as the caller gets it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/frame.h"

namespace pellucid::render {

constexpr std::size_t kDumpWords = 3;  // of a fragment: shaders/resolve/effects.glsl

// Colours of a band, samples averaged, behind those that `result` has.
void read_colors(const Buffer& final_colors, const Frame& frame, RenderResult& result);
// Of kDumpEffect; `offsets` of every pixel and sample of the band. `colored`: with their colours.
void read_fragments(const Buffer& dump, const Frame& frame, const std::vector<std::uint32_t>& offsets,
                    bool colored, RenderResult& result);

}  // namespace pellucid::render
