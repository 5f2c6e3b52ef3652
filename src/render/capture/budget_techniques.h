// budget_techniques.h - techniques that keep within a number of bytes.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

TechniqueEntry fixed_k();
TechniqueEntry hybrid();
TechniqueEntry k_plus();
TechniqueEntry variable_k();

}  // namespace pellucid::render
