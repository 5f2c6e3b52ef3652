// pellucid/deep_image.h - module `report`: deep images, which keep all fragments of every pixel.
//
// In: an image drawn with RenderOptions::keep_fragments. Out: its fragments with depth, colour, triangle and
// object, and a deep OpenEXR file, which compositing programs merge with other deep images.
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

struct DeepImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t> offsets;   // of every pixel, row by row from the upper left, and the end
  std::vector<DeepFragment> fragments;  // nearest first; at one depth by node

  // Returns the fragments of pixel (x, y), nearest first.
  [[nodiscard]] std::span<const DeepFragment> at(std::uint32_t x, std::uint32_t y) const;
};

// Collects the fragments of a result. Throws Error{bad_argument} for a result without fragments and colours,
// or with several samples per pixel.
DeepImage make_deep_image(const RenderResult& result, const RenderScene& scene, const Camera& camera);

// Writes scan lines with the channels R, G, B, A (premultiplied, 32-bit float), Z (distance), and the
// integers `object` and `node`, which count from 0. The same image gives the same bytes. The file appears
// whole or not at all. Throws Error{cannot_write}.
void write_deep_exr(const DeepImage& image, const std::string& path);

// Returns false in a build without OpenEXR (PELLUCID_OPENEXR), where write_deep_exr() throws
// Error{bad_argument}.
bool can_write_deep_exr();

}  // namespace pellucid
