#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/buffers/depth_bins.glsl"
// Marks the bins of the depth range of a pixel (B) that have fragments (D).
layout(std430, set = 0, binding = SLOT_B) readonly buffer Bounds { uint bounds[]; };
layout(std430, set = 0, binding = SLOT_D) buffer Bins { uint bins[]; };
void main() {
  const uint pixel = fragment_pixel();
  const uint bin = bin_of(gl_FragCoord.z, bounds[2u * pixel], bounds[2u * pixel + 1u]);
  atomicOr(bins[bins_of(pixel) + bin / 32u], 1u << (bin % 32u));
}
