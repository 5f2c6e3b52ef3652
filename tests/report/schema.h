// Checks JSON against a schema, for tests of written files.
#pragma once

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace pellucid::testing {

inline bool is_of_type(const nlohmann::json& value, const std::string& type) {
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  return type == "array" ? value.is_array() : value.is_object();
}

// Returns the first violation of a JSON schema, for the keywords that the schemas use; "" if there is none.
inline std::string first_violation(const nlohmann::json& value, const nlohmann::json& schema,
                                   const std::string& at = "$") {
  if (schema.contains("type")) {
    const nlohmann::json types =
        schema["type"].is_array() ? schema["type"] : nlohmann::json::array({schema["type"]});
    const bool fits = std::any_of(types.begin(), types.end(),
                                  [&](const nlohmann::json& type) { return is_of_type(value, type); });
    if (!fits) return at + ": wrong type";
  }
  if (schema.contains("const") && value != schema["const"]) return at + ": not the constant";
  if (value.is_number()) {
    if (value.get<double>() < schema.value("minimum", -std::numeric_limits<double>::infinity()))
      return at + ": too small";
    if (value.get<double>() > schema.value("maximum", std::numeric_limits<double>::infinity()))
      return at + ": too large";
  }
  for (const nlohmann::json& key : schema.value("required", nlohmann::json::array())) {
    if (!value.contains(key.get<std::string>())) return at + ": no " + key.get<std::string>();
  }
  const nlohmann::json properties = schema.value("properties", nlohmann::json::object());
  for (const auto& [key, below] : properties.items()) {
    if (!value.contains(key)) continue;
    const std::string wrong = first_violation(value[key], below, at + "." + key);
    if (!wrong.empty()) return wrong;
  }
  if (schema.contains("items")) {
    for (const nlohmann::json& item : value) {
      const std::string wrong = first_violation(item, schema["items"], at + "[]");
      if (!wrong.empty()) return wrong;
    }
  }
  return "";
}

}  // namespace pellucid::testing
