// Random viewpoints for measuring: never those that an order was made for.
#include "pellucid/view.h"

namespace pellucid {

std::vector<Viewpoint> random_viewpoints(std::uint32_t count, double min_distance, double max_distance,
                                         std::uint64_t seed) {
  const bool fixed = min_distance == max_distance;
  if (!(min_distance > 0 && min_distance <= max_distance) || (std::isinf(max_distance) && !fixed)) {
    throw Error(ErrorKind::bad_argument, "distances of viewpoints from " + std::to_string(min_distance) +
                                             " to " + std::to_string(max_distance) +
                                             " radii: give a positive, finite range, or infinity twice");
  }
  Random random(seed);
  std::vector<Viewpoint> viewpoints(count);
  for (Viewpoint& viewpoint : viewpoints) {
    viewpoint.direction = random.direction();
    viewpoint.distance = fixed ? min_distance : random.uniform(min_distance, max_distance);
  }
  return viewpoints;
}

}  // namespace pellucid
