#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#define HALVES
#include "capture/k_buffers/slots.glsl"
#include "capture/k_buffers/halves_chain.glsl"
#if defined(DEPTHS)
// First pass: keeps the depths of the nearest fragments of a pixel, as many as it has slots for.
void main() { insert_depth(place_of(fragment_pixel()), floatBitsToUint(gl_FragCoord.z)); }
#endif

#if defined(IDS)
// Second pass over the same fragments: finds the ids that belong to these depths (DEPTHS).
void main() { insert_id(place_of(fragment_pixel()), floatBitsToUint(gl_FragCoord.z), fragment_id()); }
#endif
