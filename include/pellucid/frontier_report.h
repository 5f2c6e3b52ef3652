// pellucid/frontier_report.h - module `report`, second header: error against number of buffers as a table,
// JSON and an SVG plot, so that a user picks. The keys of the JSON are a contract (docs/json.md,
// docs/schema/frontier.schema.json).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/transparency.h"

namespace pellucid {

struct PrimitiveFrontier {
  std::string name;
  std::uint32_t primitive = 0;
  std::uint64_t triangles = 0, vertices = 0;
  OrderFrontier frontier;
};

struct FrontierReport {
  std::string input, views;
  std::vector<double> distances;
  std::uint64_t seed = 0;
  double alpha = 0;            // as in OrderOptions
  double picture_alpha = 0.5;  // opacity of the pictures that PSNR is of
  double max_error = 0.001;
  std::optional<double> min_psnr;  // in the place of max_error
  bool least_frame_time = false;   // in the place of both
  std::vector<PrimitiveFrontier> primitives;
};
std::string to_text(const FrontierReport& report);
// The same bytes for the same input, options and seed: no times.
std::string to_json(const FrontierReport& report);
// One plot per primitive: error (logarithmic) and PSNR over the number of buffers, with the target, the
// number that was chosen and the knee. Readable alone, on light and dark ground; no script, no fonts of its
// own.
std::string frontier_svg(const FrontierReport& report);

}  // namespace pellucid
