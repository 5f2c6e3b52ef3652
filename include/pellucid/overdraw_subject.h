// pellucid/overdraw_subject.h - module `scene`: a model file as what overdraw orders are made for.
//
// In: a Model and the choice of its animations. Out: its opaque triangles in all key frames, as measured and
// ordered by pellucid/overdraw.h, and the orders of that as what write_model() stores.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/baseline.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"
#include "pellucid/scene.h"

namespace pellucid {

enum class SidesChoice { automatic, single, both };

struct SubjectOptions {
  SidesChoice sides = SidesChoice::automatic;  // automatic: as the materials say; other formats: single
  bool whole = false;                          // all parts are one draw call
  std::uint32_t subdivisions = 0;
  std::vector<std::string> animations;  // names or numbers; empty: all
  std::optional<double> keyframe_rate;  // per second; unset: at the key times
};

struct SubjectPart {
  std::uint32_t primitive = 0;
  std::uint32_t first_triangle = 0, triangle_count = 0;  // of the subject
};

struct PosedSubject {
  OverdrawSubject subject;           // one frame for a static mesh
  std::vector<PosedFrame> frames;    // of the subject
  std::vector<AnimationClip> clips;  // chosen; PosedFrame::clip counts these; empty: static
  std::vector<SubjectPart> parts;    // those of the subject, or of its whole
  std::vector<Vec3f> rest;
  std::vector<std::string> notes;
};
// Collects the opaque parts of the model and their poses. Throws Error{nothing_to_do} where no opaque
// triangle is drawn, Error{bad_argument} for an animation that is not there.
PosedSubject make_subject(const Model& model, const SubjectOptions& options);

// The same model in poses halfway between its key frames, and for each the key frame before it.
struct PosesBetween {
  OverdrawSubject subject;
  std::vector<std::uint32_t> nearest;
};
PosesBetween poses_between(const Model& model, const PosedSubject& posed, const SubjectOptions& options);

// Returns what write_model() needs, one entry per primitive. `options` are those that the orders were made
// with.
std::vector<OrderedPrimitive> ordered_primitives(const PosedSubject& posed, const OverdrawSets& sets,
                                                 const OverdrawOptions& options);

}  // namespace pellucid
