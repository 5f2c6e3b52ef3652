// The choice of the primitives of a model that `order` works on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid::cli {

struct SelectionOptions {
  bool all = false;      // also OPAQUE and MASK primitives of a glTF
  std::string material;  // only primitives with this material; empty: any
};

struct Selection {
  std::vector<std::uint32_t> primitives;  // indices into Model::primitives
  std::vector<std::string> notes;         // what was left out, and why
};

// Chooses what is ordered: triangle primitives that do not deform; of a glTF those drawn with BLEND, or all
// where there is none. Throws Error{nothing_to_do} when nothing is left, Error{bad_argument} for a material
// that the file does not have.
Selection select_primitives(const Model& model, const SelectionOptions& options);

}  // namespace pellucid::cli
