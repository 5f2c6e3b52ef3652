#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "resolve/effects.glsl"
// Runs after the last round of peeling. Merges what came from both ends, and writes the image.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
layout(std430, set = 0, binding = SLOT_STATE_FRONT) readonly buffer FrontStates { State front_states[]; };
#if SIDES == 2
layout(std430, set = 0, binding = SLOT_STATE_BACK) readonly buffer BackStates { State back_states[]; };
#endif
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
  State s = front_states[pixel];
#if SIDES == 2
  effect_merge(s, back_states[pixel]);
#endif
  final_colors[pixel] = effect_finish(s, pixel);
}
