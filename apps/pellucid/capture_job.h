// Draws images by a capture technique and an effect. This is the part of `render` beyond comparing orders.
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
  LensOptions lens;
  std::string animation;       // name or number; empty: at rest
  double time = 0;             // seconds, in the animation
  std::vector<Shot> shots;     // several numbered images; empty: one, from camera_text
  bool ignore_orders = false;  // draw as stored instead of in the orders of the file
  RenderOptions options;
  DeviceOptions device;
  Surfaces surfaces = Surfaces::uniform;
  SurfaceLook look;
  std::uint32_t width = 0, height = 0;
  std::string importance_image;     // path of an image; empty: none
  std::string maps;                 // folder for heat maps of techniques with a tail; empty: none
  std::string deep;                 // OpenEXR file of all fragments; empty: none
  std::vector<std::string> pixels;  // "X,Y" of each pixel whose fragments are printed
  std::uint32_t flicker = 0;        // number of frames of `compare --flicker`
  std::uint32_t frames = 1;         // the time is the median of all but the first, in which drivers compile
};

// Sets the times in `stats` to the medians of `frames`, of which there must be at least one.
void take_times(std::vector<CaptureStats> frames, CaptureStats& stats);

void render_capture(const CaptureJob& job, Session& session);

// Converts linear colours to sRGB.
Image to_image(const RenderResult& result);

}  // namespace pellucid::cli
