// JSON as every report writes it: keys in the order of the contract, two spaces, one final newline.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace pellucid {

using Json = nlohmann::ordered_json;
constexpr int kJsonSchema = 1;

// JSON has no infinity: it is written as the text "inf".
inline Json json_distance(double distance) {
  return std::isinf(distance) ? Json("inf") : Json(distance);
}

// Names come from files: bytes that are not UTF-8 become replacement characters.
inline std::string dump(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pellucid
