// pellucid/deep_image.h - module `report`: deep images, which hold all fragments of every pixel.
//
// In: an image that was drawn with RenderOptions::keep_fragments. Out: its fragments with depth, colour,
// triangle and object, and a deep OpenEXR file, which compositing programs merge with other deep images.
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
  float distance = 0;  // along the viewing direction, in units of the scene
  NodeId node = 0;     // 2 * triangle of RenderScene::triangles + (1: its back is seen)
  std::uint32_t object = 0;
  std::array<float, 4> color{};  // linear lit colour, not premultiplied, and opacity
};

struct DeepImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t>
      offsets;  // first fragment of every pixel, row by row from the upper left, and the end
  std::vector<DeepFragment> fragments;  // nearest first; at equal depth by node

  // Returns the fragments of pixel (x, y), nearest first.
  [[nodiscard]] std::span<const DeepFragment> at(std::uint32_t x, std::uint32_t y) const;
};

// Collects the fragments of a result. Throws Error{bad_argument} if the result has no fragments or colours,
// or several samples per pixel.
DeepImage make_deep_image(const RenderResult& result, const RenderScene& scene, const Camera& camera);

// Writes scan lines with the channels R, G, B, A (premultiplied, 32-bit floats), Z (distance), and the
// integers `object` and `node`, which count from 0. The same image gives the same bytes. The file appears
// complete or not at all. Throws Error{cannot_write}.
void write_deep_exr(const DeepImage& image, const std::string& path);

// Returns false in a build without OpenEXR (PELLUCID_OPENEXR=OFF), where write_deep_exr() throws
// Error{bad_argument}.
bool can_write_deep_exr();

}  // namespace pellucid
