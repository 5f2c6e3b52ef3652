// Pictures by a capture technique and an effect: what `render` does beyond comparing orders.
#pragma once

#include <string>
#include <vector>

#include "camera_options.h"
#include "pellucid/metric.h"
#include "pellucid/render.h"
#include "pellucid/scene.h"
#include "session.h"

namespace pellucid::cli {

struct CapturePicture {
  std::string input, output, camera_text;
  std::string animation;       // by name or number; empty: at rest
  double time = 0;             // in it, seconds
  std::vector<Shot> shots;     // several pictures, numbered; empty: one, by camera_text
  bool ignore_orders = false;  // else drawn in the sequence of the file's in-depth orders
  RenderOptions options;
  DeviceOptions device;
  Surfaces surfaces = Surfaces::uniform;
  SurfaceLook look;
  std::uint32_t width = 0, height = 0;
  std::string importance_image;     // path; empty: none
  std::string maps;                 // folder for heat maps of techniques with a budget; empty: none
  std::string deep;                 // OpenEXR file of all fragments; empty: none
  std::vector<std::string> pixels;  // "X,Y" each, whose fragments are printed
  std::uint32_t flicker = 0;        // frames of `compare --flicker`
  std::uint32_t frames = 1;  // drawn; the time is the median of all but the first, in which drivers compile
};

// Into `stats`: the median times of frames, at least one.
void take_times(std::vector<CaptureStats> frames, CaptureStats& stats);

void render_capture(const CapturePicture& picture, Session& session);

// Linear colours as a picture in sRGB.
Image to_image(const RenderResult& result);

}  // namespace pellucid::cli
