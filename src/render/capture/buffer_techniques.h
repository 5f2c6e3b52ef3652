// buffer_techniques.h - techniques that store many fragments of a pixel at once.
#pragma once

#include <algorithm>

#include "render/capture/technique.h"

namespace pellucid::render {

TechniqueEntry linked_lists();
TechniqueEntry bucketed_lists();
TechniqueEntry s_buffer();
TechniqueEntry fixed_arrays();
TechniqueEntry k_buffer();
TechniqueEntry multi_k_buffer();
TechniqueEntry bounded();
TechniqueEntry stencil_routing();
TechniqueEntry uniform_buckets();
TechniqueEntry adaptive_buckets();

}  // namespace pellucid::render
