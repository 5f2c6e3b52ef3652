// Implements json_fields.h: look-ups in JSON objects that fail with the place in the file.
#include "asset/gltf/json_fields.h"

#include <cmath>

namespace pellucid {
namespace {

constexpr double kLargestExactInteger = 9007199254740992.0;  // 2^53

}  // namespace

std::optional<std::uint64_t> as_index(const Json& value) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0 && number <= kLargestExactInteger) || std::floor(number) != number) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

Fields::Fields(const std::string& file, const Json& value, std::string place)
    : file_(&file), value_(&value), place_(std::move(place)) {
  if (!value.is_object()) fail("it is not a JSON object");
}

void Fields::fail(const std::string& reason) const {
  throw Error(ErrorKind::bad_input, *file_ + ": " + (place_.empty() ? "" : place_ + ": ") + reason);
}

const Json* Fields::find(const char* key) const {
  const auto found = value_->find(key);
  return found == value_->end() ? nullptr : &*found;
}

const Json* Fields::find_array(const char* key) const {
  const Json* value = find(key);
  if (value != nullptr && !value->is_array()) fail(std::string(key) + " is not an array");
  return value;
}

std::optional<Fields> Fields::find_object(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr) return std::nullopt;
  return Fields(*file_, *value, place_.empty() ? key : place_ + "." + key);
}

Fields Fields::object(const char* key) const {
  auto found = find_object(key);
  if (!found) fail(std::string(key) + " is missing");
  return *found;
}

std::optional<Fields> Fields::extension(const char* name) const {
  const auto extensions = find_object("extensions");
  return extensions ? extensions->find_object(name) : std::nullopt;
}

std::optional<std::uint64_t> Fields::find_index(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr) return std::nullopt;
  const auto index = as_index(*value);
  if (!index) fail(std::string(key) + " is not a non-negative integer");
  return index;
}

std::uint64_t Fields::index(const char* key) const {
  const auto value = find_index(key);
  if (!value) fail(std::string(key) + " is missing");
  return *value;
}

std::uint64_t Fields::index_or(const char* key, std::uint64_t fallback) const {
  return find_index(key).value_or(fallback);
}

double Fields::number(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr) fail(std::string(key) + " is missing");
  if (!value->is_number()) fail(std::string(key) + " is not a number");
  return value->get<double>();
}

double Fields::number_or(const char* key, double fallback) const {
  return has(key) ? number(key) : fallback;
}

bool Fields::flag_or(const char* key, bool fallback) const {
  const Json* value = find(key);
  if (value == nullptr) return fallback;
  if (!value->is_boolean()) fail(std::string(key) + " is neither true nor false");
  return value->get<bool>();
}

std::string Fields::text(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr) fail(std::string(key) + " is missing");
  if (!value->is_string()) fail(std::string(key) + " is not a string");
  return value->get<std::string>();
}

std::string Fields::text_or(const char* key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

std::vector<double> Fields::numbers(const char* key, std::size_t count) const {
  const Json* array = find_array(key);
  if (array == nullptr) return {};
  if (array->size() != count) fail(std::string(key) + " does not hold " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const Json& value : *array) {
    if (!value.is_number()) fail(std::string(key) + " does not hold " + std::to_string(count) + " numbers");
    values.push_back(value.get<double>());
  }
  return values;
}

Fields Fields::element(const char* array, std::uint64_t i) const {
  const Json* values = find_array(array);
  const std::string name = (place_.empty() ? "" : place_ + ".") + array + "[" + std::to_string(i) + "]";
  if (values == nullptr || i >= values->size()) {
    throw Error(ErrorKind::bad_input, *file_ + ": " + name + " is referred to but does not exist");
  }
  return {*file_, (*values)[i], name};
}

std::uint64_t Fields::element_index(const char* array, std::uint64_t i) const {
  const Json* values = find_array(array);
  const auto index = values != nullptr && i < values->size() ? as_index((*values)[i]) : std::nullopt;
  if (!index) fail(std::string(array) + "[" + std::to_string(i) + "] is not a non-negative integer");
  return *index;
}

std::uint64_t Fields::size(const char* array) const {
  const Json* values = find_array(array);
  return values == nullptr ? 0 : values->size();
}

std::string short_name(std::string name) {
  constexpr std::size_t kLongest = 200;
  if (name.size() <= kLongest) return name;
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U)
    --end;  // not inside a character
  name.resize(end);
  return name + "...";
}

}  // namespace pellucid
