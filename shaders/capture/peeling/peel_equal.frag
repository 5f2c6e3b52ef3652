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
#include "capture/peeling/peeled.glsl"
// Front to back, second pass: only fragments in the current layer pass the depth test. If there is no such
// layer, fragments at depth 1 pass, but they are peeled already.
layout(early_fragment_tests) in;
void main() {
  const uint end = near_end(fragment_pixel());
#if defined(PAIRS) || defined(CHAINS)
  const bool resumed = windows[end].x != 0u;
#else
  const bool resumed = false;
#endif
  if (!is_peeled(resumed)) store(end, false);
}
