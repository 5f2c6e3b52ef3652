// All fragments of a picture: the file of --deep, the tables of --pixel.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "capture_picture.h"
#include "pellucid/deep_image.h"

namespace pellucid::cli {

inline bool wants_fragments(const CapturePicture& picture) {
  return !picture.deep.empty() || !picture.pixels.empty();
}
// Throws Error{bad_argument} where --technique does not deliver every fragment, or a pixel is none of the
// picture.
void check_deep(const CapturePicture& picture);
// Everything is captured, opaque and hidden surfaces as well.
RenderOptions deep_options(const RenderOptions& options);

std::string pixel_tables(const CapturePicture& picture, const DeepImage& deep);
// Of every pixel: x, y and its fragments.
nlohmann::ordered_json pixels_json(const CapturePicture& picture, const DeepImage& deep);

}  // namespace pellucid::cli
