// Images by a capture technique and an effect: what `render` does beyond comparing orders.
#pragma once

#include <string>
#include <vector>

#include "camera_options.h"
#include "pellucid/metric.h"
#include "pellucid/render.h"
#include "pellucid/scene.h"
#include "session.h"

namespace pellucid::cli {

struct CaptureJob {
  std::string input, output, camera_text;
  std::string animation;       // by name or number; empty: at rest
  double time = 0;             // in it, seconds
  std::vector<Shot> shots;     // several images, numbered; empty: one, by camera_text
  bool ignore_orders = false;  // else drawn in the file's draw orders
  RenderOptions options;
  DeviceOptions device;
  Surfaces surfaces = Surfaces::uniform;
  SurfaceLook look;
  std::uint32_t width = 0, height = 0;
  std::string importance_image;     // path; empty: none
  std::string maps;                 // folder for heat maps of techniques with a tail; empty: none
  std::string deep;                 // OpenEXR file of all fragments; empty: none
  std::vector<std::string> pixels;  // "X,Y" each, whose fragments are printed
  std::uint32_t flicker = 0;        // frames of `compare --flicker`
  std::uint32_t frames = 1;  // drawn; the time is the median of all but the first, in which drivers compile
};

// Sets times in `stats` to the medians of `frames`, at least one.
void take_times(std::vector<CaptureStats> frames, CaptureStats& stats);

void render_capture(const CaptureJob& job, Session& session);

// Converts linear colours to sRGB.
Image to_image(const RenderResult& result);

}  // namespace pellucid::cli
