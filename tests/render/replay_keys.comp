#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/keys.glsl"
// Inserts a list of keys (B) of pixels (C) into their chains (A), as fragment shaders do, but all at the same
// time. Drivers that rasterise one tile after the other never run two fragments of a pixel at once.
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer List { uint64_t list[]; };
layout(std430, set = 0, binding = SLOT_C) readonly buffer Pixels { uint pixels[]; };
#include "capture/insert_key.glsl"
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.p0) insert_key(kK * pixels[i], kK, list[i]);
}
