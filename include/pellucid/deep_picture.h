// pellucid/deep_picture.h - module `report`: all fragments of every pixel, to look at and to composite with.
//
// In: a picture drawn with RenderOptions::keep_fragments. Out: its fragments with all that is known of them,
// and a deep OpenEXR file, which compositing programs merge with other deep pictures.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pellucid/raster.h"
#include "pellucid/render.h"
#include "pellucid/sequencing.h"

namespace pellucid {

struct DeepFragment {
  float depth = 0;     // 0..1, near to far
  float distance = 0;  // along the viewing direction, in the scene's units
  NodeId node = 0;     // 2 * triangle of RenderScene::triangles + (1: its back is seen)
  std::uint32_t object = 0;
  std::array<float, 4> color{};  // linear, lit, not premultiplied; opacity
};

struct DeepPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t> offsets;   // of every pixel, row by row from the upper left, and the end
  std::vector<DeepFragment> fragments;  // nearest first, of one depth by their nodes

  [[nodiscard]] std::span<const DeepFragment> at(std::uint32_t x, std::uint32_t y) const;
};

// Throws Error{bad_argument} for a picture without fragments and colours, or with several samples a pixel.
DeepPicture make_deep_picture(const RenderResult& result, const RenderScene& scene, const Camera& camera);

// Scan lines with channels R, G, B, A (premultiplied, 32-bit float), Z (distance), and of integers `object`
// and `node`; both count from 0. Same picture, same bytes. The file appears whole or not at all. Throws
// Error{cannot_write}.
void write_deep_exr(const DeepPicture& picture, const std::string& path);

// Returns false in a build without OpenEXR (PELLUCID_OPENEXR), where write_deep_exr() throws
// Error{bad_argument}.
bool can_write_deep_exr();

}  // namespace pellucid
