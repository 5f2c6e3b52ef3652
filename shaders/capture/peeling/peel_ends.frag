#version 460
#extension GL_GOOGLE_include_directive : require
#if defined(CHAINS)
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "counters.glsl"
#include "capture/peeling/layers.glsl"
#include "capture/peeling/store_layer.glsl"
// Peeling without the depth test: stores the fragments in the current layers, and finds the next layers
// between them. The first round has no current layers, so everything lies between them.
void main() {
  const uint pixel = fragment_pixel();
  const uint key = key_of(gl_FragCoord.z);
  const uint near = push.round == 0u ? 0u : depths[near_end(pixel)].x;
#if SIDES == 2
  const uint far = push.round == 0u ? kNone : depths[far_end(pixel)].x;
#else
  const uint far = kNone;
#endif
  if (key == near) store(near_end(pixel), false);
  else if (key == far) store(far_end(pixel), true);
#if defined(PAIRS)
  if (kVariant == 0u) return;
#endif
  if (key <= near || key >= far) return;
  atomicMax(depths[near_end(pixel)].y, ~key);
#if SIDES == 2
  atomicMax(depths[far_end(pixel)].y, key);
#endif
}
