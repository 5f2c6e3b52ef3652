#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "scene/opaque.glsl"
#include "capture/blending/ordered_window.glsl"
// The last step of the ordered k-buffer: blends what is left in the window, nearest first, under what was
// blended before, and all of it over the background. Counts the pixels in which a fragment came too late.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
layout(set = 0, binding = SLOT_IMAGE_0) uniform utexture2DArray layers;

uint word_at(ivec2 pixel, uint i) { return texelFetch(layers, ivec3(pixel, i / 4u), 0)[i % 4u]; }
uvec3 slot_at(ivec2 pixel, uint i) {
  return uvec3(word_at(pixel, 3u * i), word_at(pixel, 3u * i + 1u), word_at(pixel, 3u * i + 2u));
}

vec4 blended_before(ivec2 pixel) {
  if (word_at(pixel, kFarthestWord + 1u) == kNone) return kNothingBlended;
  uvec4 bits;
  for (uint i = 0u; i < 4u; ++i) bits[i] = word_at(pixel, kBlendedWord + i);
  return uintBitsToFloat(bits);
}

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  vec4 blended = blended_before(at);
  for (uint i = kK; i > 0u; --i) {
    const uvec3 slot = slot_at(at, i - 1u);
    if (!is_free(slot)) blended = blended_under(blended, slot.z);
  }
  const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
  final_colors[pixel] = vec4(blended.rgb + blended.a * background_of(pixel), 1.0 - blended.a);
  if (word_at(at, kLateWord) != kNone) atomicAdd(counters.misordered_pixels, 1u);
}
