// Internal to the module `asset`: single numbers as glTF stores them (glTF 2.0, sections 3.6.2.2 and 3.11).
#pragma once

#include <cstdint>

#include "asset/gltf_document.h"

namespace pellucid {

enum ComponentType : std::uint64_t {
  signed_byte = 5120,
  unsigned_byte = 5121,
  signed_short = 5122,
  unsigned_short = 5123,
  unsigned_int = 5125,
  single_float = 5126,
};
// 0 for a type that does not exist.
std::uint64_t bytes_of(std::uint64_t component_type);

// Normalised integers map to [-1, 1] or [0, 1]; others are taken as they are.
float real_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized);
// An unsigned integer.
std::uint32_t scalar_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type);

// The nearest value that can be stored.
void store_real(double value, Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized);
void store_scalar(std::uint32_t value, Bytes& bytes, std::size_t at, std::uint64_t component_type);

}  // namespace pellucid
