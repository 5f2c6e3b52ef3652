// Models at a moment of an animation: see pellucid/scene.h.
#include <cmath>

#include "scene/posable_data.h"

namespace pellucid {
namespace {

constexpr double kMostTimes = 1e6;
// Of a step: a last key time that misses a step by rounding is not followed by another.
constexpr double kRounding = 1e-6;

}  // namespace

std::vector<double> times_at_rate(const AnimationClip& clip, double rate) {
  if (!(rate > 0) || !std::isfinite(rate)) {
    throw Error(ErrorKind::bad_argument, "a rate of key frames must be positive");
  }
  if (clip.key_times.empty()) return {};
  const double first = clip.key_times.front(), last = clip.key_times.back();
  const double steps = std::ceil((last - first) * rate - kRounding);
  if (steps > kMostTimes) {
    throw Error(ErrorKind::bad_argument, clip.name + ": " + std::to_string(rate) +
                                             " key frames a second are more than a million in all");
  }
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(steps) + 1);
  for (int step = 0; step < steps; ++step) times.push_back(first + step / rate);
  times.push_back(last);
  return times;
}

PosableModel::PosableModel(const Model& model, std::uint32_t subdivisions)
    : data_(std::make_shared<const PosableData>(make_posable(model, subdivisions))) {}

const std::vector<Triangle>& PosableModel::triangles() const {
  return data_->triangles;
}

const std::vector<ModelPart>& PosableModel::parts() const {
  return data_->parts;
}

const std::vector<AnimationClip>& PosableModel::clips() const {
  return data_->clips;
}

std::vector<Vec3f> PosableModel::rest_pose() const {
  std::vector<Vec3f> positions;
  data_->pose(data_->rest, 0, positions);
  return positions;
}

void PosableModel::pose(std::uint32_t clip, double time, std::vector<Vec3f>& positions) const {
  if (clip >= data_->clips.size()) {
    throw Error(ErrorKind::bad_argument, "clip " + std::to_string(clip) + " does not exist; there are " +
                                             std::to_string(data_->clips.size()));
  }
  data_->pose(data_->clip_motions[clip], time, positions);
}

}  // namespace pellucid
