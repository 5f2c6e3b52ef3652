// Lets capture techniques draw the same scene in turns. This is what `compare` measures.
#pragma once

#include <string>
#include <vector>

#include "capture_job.h"
#include "pellucid/compare_report.h"
#include "session.h"

namespace pellucid::cli {

// A scene as `compare` draws it, and as sweeps vary it.
struct DrawnScene {
  std::string input;
  RenderScene scene;
  Camera camera;
  std::vector<Camera> turn{};        // for --flicker: around the scene, beginning at `camera`
  std::vector<std::string> notes{};  // what of the surfaces could not be read or is not drawn
};
DrawnScene open_scene(const Model& model, const CaptureJob& job);

struct ComparisonOptions {
  std::vector<std::string> techniques;
  bool cpu_reference = false;  // the exact image is that of the CPU, not of `sb`
  std::uint32_t frames = 6;    // if there are several, the first is not timed
  RenderOptions draw;          // everything except the technique
};

// Loads the scene. Techniques that cannot draw it get a row that says why. Throws Error{interrupted}.
ComparedScene compare_techniques(Renderer& renderer, const DrawnScene& drawn,
                                 const ComparisonOptions& options, Session& session);

ComparedSweep sweep(Renderer& renderer, const DrawnScene& drawn, SweepKind kind,
                    const ComparisonOptions& options, Session& session);

}  // namespace pellucid::cli
