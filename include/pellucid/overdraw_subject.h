// pellucid/overdraw_subject.h - module `scene`: turns a model file into the input of overdraw orders, and the
// result back into the form that a file stores.
//
// In: a Model and the choice of its animations. Out: its opaque triangles in all key frames, which
// pellucid/overdraw.h orders and measures; and, for the orders of these, the order sets that write_model()
// takes.
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
  SidesChoice sides = SidesChoice::automatic;  // automatic: as glTF materials say; other formats: single
  bool whole = false;                          // treats all parts as one draw call
  std::uint32_t subdivisions = 0;              // levels of Loop subdivision
  std::vector<std::string> animations;         // names or numbers; empty: all
  std::optional<double> keyframe_rate;         // per second; unset: at the key times
};

// The triangles of the subject that one instance of a primitive draws.
struct SubjectPart {
  std::uint32_t primitive = 0;  // index into Model::primitives
  std::uint32_t first_triangle = 0, triangle_count = 0;
};

struct PosedSubject {
  OverdrawSubject subject;           // one frame for a static model
  std::vector<PosedFrame> frames;    // clip and time of each frame of the subject
  std::vector<AnimationClip> clips;  // the chosen ones; PosedFrame::clip is an index; empty: static
  std::vector<SubjectPart> parts;    // also with SubjectOptions::whole, where the subject itself has one part
  std::vector<Vec3f> rest;           // positions at rest
  std::vector<std::string> notes;
};
// Collects the opaque parts of the model and their poses. Throws Error{nothing_to_do} if no opaque triangle
// is drawn, and Error{bad_argument} for an animation that does not exist.
PosedSubject make_subject(const Model& model, const SubjectOptions& options);

// The same model in poses halfway between its key frames.
struct PosesBetween {
  OverdrawSubject subject;
  std::vector<std::uint32_t> nearest;  // per pose: the index of the key frame before it
};
// Makes these poses.
PosesBetween poses_between(const Model& model, const PosedSubject& posed, const SubjectOptions& options);

// Returns what write_model() takes, one entry per primitive. `options` are those that the orders were made
// with.
std::vector<OrderedPrimitive> ordered_primitives(const PosedSubject& posed, const OverdrawSets& sets,
                                                 const OverdrawOptions& options);

}  // namespace pellucid
