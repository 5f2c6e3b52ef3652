// Places for names beside points of a chart: see label_places.h.
#include "report/label_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pellucid {
namespace {

constexpr double kCharacterWidth = 7;  // of 12 px text, more than most
constexpr double kTextHeight = 14;
constexpr double kPointRadius = 5;  // with what has to stay free round it
constexpr double kNear = 8;
constexpr double kRing = 14;  // from one ring of places to the next
constexpr int kRings = 12;
constexpr int kDirections = 16;

// A name whose nearest edge is `distance` from its point, in the direction of an angle from the right.
LabelBox box_towards(const LabelPoint& point, double angle, double distance) {
  const double width = kCharacterWidth * static_cast<double>(point.name.size());
  const double x = std::cos(angle);
  const double y = std::sin(angle);
  const double middle_x = point.x + x * (distance + width / 2);
  const double middle_y = point.y + y * (distance + kTextHeight / 2);
  return {middle_x - width / 2, middle_y - kTextHeight / 2, middle_x + width / 2, middle_y + kTextHeight / 2};
}

std::vector<PlacedLabel> places_of(const LabelPoint& point) {
  std::vector<PlacedLabel> places;
  // Right, left, above, below.
  for (const double angle : {0.0, std::numbers::pi, -std::numbers::pi / 2, std::numbers::pi / 2})
    places.push_back({box_towards(point, angle, kNear), false});
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int d = 0; d < kDirections; ++d) {
      const double angle = 2 * std::numbers::pi * d / kDirections;
      places.push_back({box_towards(point, angle, kNear + kRing * ring), true});
    }
  }
  return places;
}

}  // namespace

std::vector<PlacedLabel> place_labels(const std::vector<LabelPoint>& points, const LabelBox& area) {
  std::vector<LabelBox> taken;
  taken.reserve(2 * points.size());
  for (const LabelPoint& p : points)
    taken.push_back({p.x - kPointRadius, p.y - kPointRadius, p.x + kPointRadius, p.y + kPointRadius});
  const auto is_free = [&](const PlacedLabel& place) {
    return area.holds(place.box) && std::none_of(taken.begin(), taken.end(), [&](const LabelBox& other) {
             return place.box.meets(other);
           });
  };
  std::vector<PlacedLabel> labels;
  for (const LabelPoint& point : points) {
    const std::vector<PlacedLabel> places = places_of(point);
    const auto found = std::find_if(places.begin(), places.end(), is_free);
    labels.push_back(found == places.end() ? places.front() : *found);
    taken.push_back(labels.back().box);
  }
  return labels;
}

}  // namespace pellucid
