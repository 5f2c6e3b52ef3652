// The choice of the primitives of a model that `order` works on. In: options. Out: indices of primitives, and
// notes on the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid::cli {

struct SelectionOptions {
  bool all = false;      // order OPAQUE and MASK primitives, too
  std::string material;  // only primitives with this material; empty: any
};

struct Selection {
  std::vector<std::uint32_t> primitives;  // indices into Model::primitives
  std::vector<std::string> notes;         // what was left out, and why
};

// Chooses the primitives to order: triangle primitives that do not deform. It chooses those drawn with BLEND,
// or all if there is none. A mesh without a material counts as BLEND. Throws Error{nothing_to_do} if nothing
// is left, and Error{bad_argument} for a material that the file does not have.
Selection select_primitives(const Model& model, const SelectionOptions& options);

}  // namespace pellucid::cli
