// blending_techniques.h - techniques that deliver no list of fragments: they blend while they draw.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// Premultiplied colours, and 1 - transmittance.
constexpr VkFormat kBlended = VK_FORMAT_R32G32B32A32_SFLOAT;

TechniqueEntry plain_blend();
TechniqueEntry verified_blend();
TechniqueEntry ordered_k();
// Approximations that keep what they know of a pixel in a fixed number of bytes.
TechniqueEntry weighted_blend();
TechniqueEntry moment_blend();
TechniqueEntry multi_layer_blend();
TechniqueEntry stochastic_blend();

}  // namespace pellucid::render
