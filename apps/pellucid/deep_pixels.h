// All fragments of an image: the file of --deep and the tables of --pixel.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "capture_job.h"
#include "pellucid/deep_image.h"

namespace pellucid::cli {

inline bool wants_fragments(const CaptureJob& job) {
  return !job.deep.empty() || !job.pixels.empty();
}
// Throws Error{bad_argument} if --technique does not deliver every fragment, or a pixel is outside the image.
void check_deep(const CaptureJob& job);
// Returns options that capture everything, including opaque and hidden surfaces.
RenderOptions deep_options(const RenderOptions& options);

std::string pixel_tables(const CaptureJob& job, const DeepImage& deep);
// Returns x, y and the fragments of every pixel of --pixel.
nlohmann::ordered_json pixels_json(const CaptureJob& job, const DeepImage& deep);

}  // namespace pellucid::cli
