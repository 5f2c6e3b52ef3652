// Internal to the module `asset`: typed look-ups in JSON objects that fail with "FILE: PLACE: reason".
#pragma once

#include <optional>
#include <string>

#include "asset/gltf_document.h"

namespace pellucid {

// A non-negative integer, also where its writer put it as 3.0; nothing for any other value.
std::optional<std::uint64_t> as_index(const Json& value);

// One JSON object and where it lies ("bunny.glb", "accessors[3]"). Refers to both: keep them alive.
class Fields {
 public:
  Fields(const std::string& file, const Json& value, std::string place);

  [[noreturn]] void fail(const std::string& reason) const;
  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const Json& json() const { return *value_; }

  // Null where the key is missing.
  [[nodiscard]] const Json* find(const char* key) const;
  [[nodiscard]] bool has(const char* key) const { return find(key) != nullptr; }
  // Null where missing; fails where it is something else.
  [[nodiscard]] const Json* find_array(const char* key) const;
  [[nodiscard]] std::optional<Fields> find_object(const char* key) const;
  [[nodiscard]] Fields object(const char* key) const;
  // extensions[name]
  [[nodiscard]] std::optional<Fields> extension(const char* name) const;

  // Non-negative integers.
  [[nodiscard]] std::optional<std::uint64_t> find_index(const char* key) const;
  [[nodiscard]] std::uint64_t index(const char* key) const;
  [[nodiscard]] std::uint64_t index_or(const char* key, std::uint64_t fallback) const;

  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number_or(const char* key, double fallback) const;
  [[nodiscard]] bool flag_or(const char* key, bool fallback) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] std::string text_or(const char* key, const std::string& fallback) const;
  // An array of exactly `count` numbers; empty where missing.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const;

  // array[i] as an object, as a non-negative integer.
  [[nodiscard]] Fields element(const char* array, std::uint64_t i) const;
  [[nodiscard]] std::uint64_t element_index(const char* array, std::uint64_t i) const;
  // Length of an array; 0 where missing.
  [[nodiscard]] std::uint64_t size(const char* array) const;

 private:
  const std::string* file_;
  const Json* value_;
  std::string place_;
};

// Names may be any text of any length; messages and lists hold the first 200 bytes.
std::string short_name(std::string name);

}  // namespace pellucid
