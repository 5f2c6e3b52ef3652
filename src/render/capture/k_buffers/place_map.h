// place_map.h - decides how many slots of a pool each pixel gets and where they lie. A survey counts the
// fragments, then importance is computed, and then places are numbered (shaders/capture/k_buffers).
#pragma once

#include "render/capture/k_buffers/memory_plan.h"
#include "render/frame.h"

namespace pellucid::render {

// How slots are given out: kK of shaders/capture/k_buffers/place_map.glsl.
enum class Sharing : std::uint32_t { water, uniform, printed };

struct Importance {
  std::uint32_t terms = 0;  // sum of ImportanceTerm values
  bool depths = true;       // sum up optical depths, for `opacity` and for weights in tails
  bool packed = false;      // sum and number of fragments share a word
  ImportanceOptions options;
  [[nodiscard]] bool has(ImportanceTerm term) const {
    return (terms & static_cast<std::uint32_t>(term)) != 0;
  }
  // Returns the number of words per pixel that shaders/capture/k_buffers/survey.glsl takes.
  [[nodiscard]] std::uint64_t survey_words() const {
    return 1U + (depths && !packed ? 1U : 0U) + (has(ImportanceTerm::fresnel) ? 1U : 0U);
  }
};

// The map from pixels to places, and the kernels that compute it. The pool is bound to slot A.
class PlaceMap {
 public:
  void allocate(Frame& frame, const MappedPlan& plan, Sharing sharing, const Importance& importance);
  // Records the kernels. `given` has the bytes that the terms `image` and `residue` read. Afterwards the map
  // is in slot B.
  void record(const Frame& frame, Recorder& recorder, const Buffer& pool, const Buffer& given) const;
  // Return the words of the map (shaders/capture/k_buffers/places.glsl), and the importance if
  // BudgetOptions::maps asks for it. Wait for the device.
  [[nodiscard]] std::vector<std::uint32_t> places(const Frame& frame) const;
  [[nodiscard]] std::vector<float> importance(const Frame& frame) const;

 private:
  Sharing sharing_ = Sharing::water;
  std::uint32_t terms_ = 0;  // kVariant of shaders/capture/k_buffers/survey.glsl
  Buffer map_, state_, kept_importance_;
};

}  // namespace pellucid::render
