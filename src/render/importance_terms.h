// importance_terms.h - what terms of importance can go by.
#pragma once

#include "pellucid/base.h"
#include "pellucid/budget.h"

namespace pellucid::render {

// Throws Error{bad_argument} for parameters that are not numbers or out of range, and for an image that its
// size does not fit.
void check_importance(const ImportanceOptions& options);

}  // namespace pellucid::render
