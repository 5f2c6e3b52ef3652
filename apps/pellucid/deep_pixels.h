// All fragments of an image: the file of --deep, the tables of --pixel.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "capture_job.h"
#include "pellucid/deep_image.h"

namespace pellucid::cli {

inline bool wants_fragments(const CaptureJob& job) {
  return !job.deep.empty() || !job.pixels.empty();
}
// Throws Error{bad_argument} where --technique does not deliver every fragment, or a pixel lies outside of
// the image.
void check_deep(const CaptureJob& job);
// Returns options with which everything is captured, opaque and hidden surfaces as well.
RenderOptions deep_options(const RenderOptions& options);

std::string pixel_tables(const CaptureJob& job, const DeepImage& deep);
// Of every pixel: x, y and its fragments.
nlohmann::ordered_json pixels_json(const CaptureJob& job, const DeepImage& deep);

}  // namespace pellucid::cli
