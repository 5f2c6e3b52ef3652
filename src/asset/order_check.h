// Internal to the module `asset`: is what a caller wants to write an order set of this model?
#pragma once

#include "pellucid/asset.h"

namespace pellucid {

// Throws Error{bad_argument} naming the primitive and the reason.
void check_orders(const Model& model, const std::vector<OrderedPrimitive>& ordered);

}  // namespace pellucid
