// place_map.h - decides how many slots of a pool each pixel gets, and where they lie: a survey counts
// fragments, their importance is computed, and places are numbered (shaders/capture/k_buffers).
#pragma once

#include "render/capture/k_buffers/memory_plan.h"
#include "render/frame.h"

namespace pellucid::render {

// shaders/capture/k_buffers/place_map.glsl: kK.
enum class Sharing : std::uint32_t { water, uniform, printed };

struct Importance {
  std::uint32_t terms = 0;  // a sum of ImportanceTerm
  bool depths = true;       // optical depths are summed up: for `opacity`, and for weights in tails
  bool packed = false;      // with the number of fragments in one word
  ImportanceOptions options;
  [[nodiscard]] bool has(ImportanceTerm term) const {
    return (terms & static_cast<std::uint32_t>(term)) != 0;
  }
  // Words of a pixel that shaders/capture/k_buffers/survey.glsl takes.
  [[nodiscard]] std::uint64_t survey_words() const {
    return 1U + (depths && !packed ? 1U : 0U) + (has(ImportanceTerm::fresnel) ? 1U : 0U);
  }
};

// The buffers that places are described by, and how they come about. The pool is bound to slot A.
class PlaceMap {
 public:
  void allocate(Frame& frame, const MappedPlan& plan, Sharing sharing, const Importance& importance);
  // `given`: bytes that the terms `image` and `residue` look at. Afterwards places are in slot B.
  void record(const Frame& frame, Recorder& recorder, const Buffer& pool, const Buffer& given) const;
  // Waits for the device. Words of shaders/capture/k_buffers/places.glsl; importance where
  // BudgetOptions::maps asks for it.
  [[nodiscard]] std::vector<std::uint32_t> places(const Frame& frame) const;
  [[nodiscard]] std::vector<float> importance(const Frame& frame) const;

 private:
  Sharing sharing_ = Sharing::water;
  std::uint32_t terms_ = 0;  // kVariant of shaders/capture/k_buffers/survey.glsl
  Buffer map_, state_, kept_importance_;
};

}  // namespace pellucid::render
