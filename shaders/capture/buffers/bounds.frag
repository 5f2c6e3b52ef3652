#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Finds the nearest and farthest depth of every pixel. B has two words (bits) per pixel, which start at kNone
// and 0.
layout(std430, set = 0, binding = SLOT_B) buffer Bounds { uint bounds[]; };
void main() {
  const uint pixel = fragment_pixel();
  const uint depth = floatBitsToUint(gl_FragCoord.z);
  atomicMin(bounds[2u * pixel], depth);
  atomicMax(bounds[2u * pixel + 1u], depth);
}
