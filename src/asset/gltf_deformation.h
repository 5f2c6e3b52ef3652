// Internal to the module `asset`: what a glTF primitive's vertices follow: joints and morph targets.
#pragma once

#include <span>

#include "asset/accessor_reader.h"
#include "pellucid/animation.h"

namespace pellucid {

// `fields` is meshes[mesh].primitives[index], which has `vertices` vertices.
RigPrimitive read_deformation(const Fields& fields, std::uint64_t vertices, AccessorReader& accessors);

// Components as numbers, back to back. Fails where `source` is of another type or of a component type that
// is neither float nor normalised 8- or 16-bit integers.
std::vector<float> read_reals(std::uint64_t accessor, const std::string& type, AccessorReader& accessors);

// -1 where all are finite, else the first that is not.
std::ptrdiff_t find_non_finite(std::span<const float> values);

}  // namespace pellucid
