// Single numbers as glTF stores them: see component.h.
#include "asset/component.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pellucid {
namespace {

template <class Component>
Component component_at(const Bytes& bytes, std::size_t at) {
  Component value{};
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

template <class Component>
void put(Component value, Bytes& bytes, std::size_t at) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

template <class Integer>
float to_real(Integer value, bool normalized) {
  if (!normalized) return static_cast<float>(value);
  return std::max(static_cast<float>(value) / static_cast<float>(std::numeric_limits<Integer>::max()), -1.0F);
}

template <class Integer>
Integer from_real(double value, bool normalized) {
  constexpr double kLeast = std::numeric_limits<Integer>::min();
  constexpr double kMost = std::numeric_limits<Integer>::max();
  const double scaled = std::round(normalized ? value * kMost : value);
  return static_cast<Integer>(std::clamp(scaled, normalized && kLeast < 0 ? -kMost : kLeast, kMost));
}

}  // namespace

std::uint64_t bytes_of(std::uint64_t component_type) {
  switch (component_type) {
    case signed_byte:
    case unsigned_byte:
      return 1;
    case signed_short:
    case unsigned_short:
      return 2;
    case unsigned_int:
    case single_float:
      return 4;
    default:
      return 0;
  }
}

float real_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized) {
  switch (component_type) {
    case signed_byte:
      return to_real(component_at<std::int8_t>(bytes, at), normalized);
    case unsigned_byte:
      return to_real(component_at<std::uint8_t>(bytes, at), normalized);
    case signed_short:
      return to_real(component_at<std::int16_t>(bytes, at), normalized);
    case unsigned_short:
      return to_real(component_at<std::uint16_t>(bytes, at), normalized);
    default:
      return component_at<float>(bytes, at);
  }
}

std::uint32_t scalar_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type) {
  switch (component_type) {
    case unsigned_byte:
      return component_at<std::uint8_t>(bytes, at);
    case unsigned_short:
      return component_at<std::uint16_t>(bytes, at);
    default:
      return component_at<std::uint32_t>(bytes, at);
  }
}

void store_real(double value, Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized) {
  switch (component_type) {
    case signed_byte:
      return put(from_real<std::int8_t>(value, normalized), bytes, at);
    case unsigned_byte:
      return put(from_real<std::uint8_t>(value, normalized), bytes, at);
    case signed_short:
      return put(from_real<std::int16_t>(value, normalized), bytes, at);
    case unsigned_short:
      return put(from_real<std::uint16_t>(value, normalized), bytes, at);
    default:
      return put(static_cast<float>(value), bytes, at);
  }
}

void store_scalar(std::uint32_t value, Bytes& bytes, std::size_t at, std::uint64_t component_type) {
  switch (component_type) {
    case unsigned_byte:
      return put(static_cast<std::uint8_t>(value), bytes, at);
    case unsigned_short:
      return put(static_cast<std::uint16_t>(value), bytes, at);
    default:
      return put(value, bytes, at);
  }
}

}  // namespace pellucid
