// Internal to the module `asset`: typed look-ups in the JSON objects of a glTF file. A look-up that fails
// throws Error{bad_input} with the text "FILE: PLACE: reason".
#pragma once

#include <optional>
#include <string>

#include "asset/gltf/document.h"

namespace pellucid {

// Returns a non-negative integer, also if it is written as 3.0, and nothing for any other value.
std::optional<std::uint64_t> as_index(const Json& value);

// One JSON object and its place in a file ("bunny.glb", "accessors[3]"). Refers to the file name and the
// JSON, which must outlive it.
class Fields {
 public:
  Fields(const std::string& file, const Json& value, std::string place);

  [[noreturn]] void fail(const std::string& reason) const;
  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const Json& json() const { return *value_; }

  // Returns the value of a key, or null if it is missing.
  [[nodiscard]] const Json* find(const char* key) const;
  [[nodiscard]] bool has(const char* key) const { return find(key) != nullptr; }
  // Returns the array of a key, or null if it is missing. Fails if the value is not an array.
  [[nodiscard]] const Json* find_array(const char* key) const;
  [[nodiscard]] std::optional<Fields> find_object(const char* key) const;
  [[nodiscard]] Fields object(const char* key) const;
  // Returns the extension of that name, if the object has it.
  [[nodiscard]] std::optional<Fields> extension(const char* name) const;

  // Return non-negative integers.
  [[nodiscard]] std::optional<std::uint64_t> find_index(const char* key) const;
  [[nodiscard]] std::uint64_t index(const char* key) const;
  [[nodiscard]] std::uint64_t index_or(const char* key, std::uint64_t fallback) const;

  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number_or(const char* key, double fallback) const;
  [[nodiscard]] bool flag_or(const char* key, bool fallback) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] std::string text_or(const char* key, const std::string& fallback) const;
  // Returns an array of exactly `count` numbers, or an empty one if the key is missing.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const;

  // Returns array[i] as an object, or as a non-negative integer.
  [[nodiscard]] Fields element(const char* array, std::uint64_t i) const;
  [[nodiscard]] std::uint64_t element_index(const char* array, std::uint64_t i) const;
  // Returns the length of an array, or 0 if the key is missing.
  [[nodiscard]] std::uint64_t size(const char* array) const;

 private:
  const std::string* file_;
  const Json* value_;
  std::string place_;
};

// Returns the first 200 bytes of a name. Names in files may be of any length, but messages and lists must not
// be.
std::string short_name(std::string name);

}  // namespace pellucid
