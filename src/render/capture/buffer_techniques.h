// buffer_techniques.h - techniques that store all fragments at once and sort them afterwards.
#pragma once

#include <algorithm>

#include "technique.h"

namespace pellucid::render {

TechniqueEntry linked_lists();
TechniqueEntry bucketed_lists();
TechniqueEntry s_buffer();
TechniqueEntry fixed_arrays();

}  // namespace pellucid::render
