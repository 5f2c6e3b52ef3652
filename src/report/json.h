// Makes what all JSON reports share: the order of keys, two spaces of indentation, one final newline. In:
// values of a report. Out: JSON (docs/json.md).
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "pellucid/mesh.h"

namespace pellucid {

using Json = nlohmann::ordered_json;
constexpr int kJsonSchema = 1;

// Returns a distance. JSON has no infinity, which becomes the text "inf".
inline Json json_distance(double distance) {
  return std::isinf(distance) ? Json("inf") : Json(distance);
}

inline Json json_of(const MeshReport& check) {
  return {{"vertices", check.vertices},
          {"triangles", check.triangles},
          {"out_of_range", check.out_of_range},
          {"non_finite", check.non_finite},
          {"degenerate", check.degenerate},
          {"duplicate", check.duplicate},
          {"unreferenced_vertices", check.unreferenced_vertices},
          {"boundary_edges", check.boundary_edges},
          {"non_manifold_edges", check.non_manifold_edges},
          {"closed", check.closed()}};
}

// Returns the text of a report. Names come from files, so bytes that are not UTF-8 become replacement
// characters.
inline std::string dump(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pellucid
