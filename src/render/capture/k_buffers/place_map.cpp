// Implements place_map.h: the kernels that survey fragments, compute importance and number the places.
#include "render/capture/k_buffers/place_map.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace pellucid::render {
namespace {

// The first members of the state in shaders/capture/k_buffers/place_map.glsl (std430): those that do not
// start as 0.
struct BudgetState {
  std::uint32_t slots = 0;
  float alpha = 0, limit = 0, falloff = 0;
  std::array<float, 2> point{};
  float noise = 0;
  std::uint32_t covered = 0, leftover = 0, level = 0, image_width = 0, image_height = 0;
  std::uint64_t importance_sum = 0, unused = 0;
  std::array<std::uint64_t, 128> sums{};
};
static_assert(sizeof(BudgetState) == kBudgetHead);

// Also in shaders/capture/k_buffers/survey.glsl.
constexpr std::uint32_t kDepthSurvey = 64;
constexpr std::uint32_t kPackedSurvey = 128;
constexpr std::uint32_t kSearchRounds = 8;  // each finds four bits of the level

struct Groups {
  std::uint32_t x, y;
};
// Vulkan guarantees 65,535 groups in one dimension.
Groups groups_of(std::uint64_t pixels) {
  const auto count = static_cast<std::uint32_t>((pixels + kGroupPixels - 1) / kGroupPixels);
  constexpr std::uint32_t kMost = 32768;
  return {std::min(count, kMost), (count + kMost - 1) / kMost};
}

}  // namespace

void PlaceMap::allocate(Frame& frame, const MappedPlan& plan, Sharing sharing, const Importance& importance) {
  sharing_ = sharing;
  terms_ =
      importance.terms | (importance.depths ? kDepthSurvey : 0U) | (importance.packed ? kPackedSurvey : 0U);
  map_ = frame.make_buffer("map of places", plan.map_bytes);
  state_ = frame.make_buffer("budget", plan.state_bytes);
  // This copy is only for BudgetOptions::maps, so it does not count as memory of the technique.
  if (frame.options.budget.maps) kept_importance_ = Buffer(frame.context, "importance map", plan.map_bytes);
  const ImportanceOptions& o = importance.options;
  BudgetState state{.slots = static_cast<std::uint32_t>(plan.slots),
                    .alpha = static_cast<float>(o.alpha),
                    .limit = static_cast<float>(o.limit),
                    .falloff = static_cast<float>(o.falloff),
                    .point = {static_cast<float>(o.focus_x), static_cast<float>(o.focus_y)},
                    .noise = static_cast<float>(o.noise),
                    .covered = static_cast<std::uint32_t>(frame.covered),
                    .image_width = o.image.width,
                    .image_height = o.image.height};
  upload<BudgetState>(frame.context, state_, std::span(&state, 1));
}

void PlaceMap::record(const Frame& frame, Recorder& recorder, const Buffer& pool, const Buffer& given) const {
  const auto [x, y] = groups_of(frame.pixels());
  const Constants constants{frame.effect, static_cast<std::uint32_t>(sharing_), terms_};
  const auto dispatch = [&, groups_x = x, groups_y = y](std::string_view shader) {
    recorder.dispatch(frame.pipelines.compute(shader, constants), groups_x, groups_y);
    recorder.barrier();
  };
  recorder.bind(Slot::a, pool);
  recorder.bind(Slot::c, state_);
  if (given) recorder.bind(Slot::d, given);
  const auto clear_sums = [&] {
    constexpr std::size_t kSums = offsetof(BudgetState, importance_sum);
    recorder.fill(state_, 0, kSums, sizeof(BudgetState) - kSums);
    recorder.barrier();
  };
  recorder.fill(pool, 0);
  clear_sums();
  frame.gather(recorder, "capture/k_buffers/survey.frag", constants);
  recorder.barrier();
  if (kept_importance_) {
    recorder.bind(Slot::b, kept_importance_);
    dispatch("capture/k_buffers/importance.comp");
    clear_sums();
  }
  recorder.bind(Slot::b, map_);
  dispatch("capture/k_buffers/importance.comp");
  if (sharing_ != Sharing::printed) {
    for (std::uint32_t round = 0; round <= kSearchRounds; ++round) {
      recorder.push().round = round;
      dispatch("capture/k_buffers/level.comp");
    }
  }
  dispatch("capture/k_buffers/sum_groups.comp");
  recorder.dispatch(frame.pipelines.compute("capture/k_buffers/scan_groups.comp", constants), 1, 1);
  recorder.barrier();
  dispatch("capture/k_buffers/places.comp");
}

std::vector<std::uint32_t> PlaceMap::places(const Frame& frame) const {
  std::vector<std::uint32_t> words(frame.pixels() + 1);
  map_.download(frame.context, std::as_writable_bytes(std::span(words)));
  return words;
}

std::vector<float> PlaceMap::importance(const Frame& frame) const {
  std::vector<float> values(frame.pixels());
  kept_importance_.download(frame.context, std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace pellucid::render
