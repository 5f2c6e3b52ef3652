#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_fragment_shader_interlock : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Keeps the kK nearest fragments in kK slots (A) of three words. The fragments of a pixel run one at a time
// (fragment shader interlock).
layout(pixel_interlock_unordered) in;
layout(std430, set = 0, binding = SLOT_A) coherent buffer Slots { uint words[]; };
#define SLOTS kK
uint first;
uvec3 slot_at(uint i) { return uvec3(words[first + 3u * i], words[first + 3u * i + 1u], words[first + 3u * i + 2u]); }
void put_slot(uint i, uvec3 f) {
  words[first + 3u * i] = f.x;
  words[first + 3u * i + 1u] = f.y;
  words[first + 3u * i + 2u] = f.z;
}
#include "capture/insert_fragment.glsl"

void main() {
  first = 3u * kK * fragment_pixel();
  const uvec3 fragment = uvec3(floatBitsToUint(gl_FragCoord.z), fragment_id(), fragment_color());
  beginInvocationInterlockARB();
  if (is_before(fragment, slot_at(kK - 1u))) insert_fragment(fragment);
  endInvocationInterlockARB();
}
