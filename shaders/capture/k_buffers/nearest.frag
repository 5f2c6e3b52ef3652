#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/keys.glsl"
#if defined(KEYS)
// First pass: keeps the keys of the kK nearest fragments. A has kK increasing keys per pixel.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
#include "capture/insert_key.glsl"
void main() { insert_key(kK * fragment_pixel(), kK, make_key(gl_FragCoord.z, fragment_id())); }
#endif

#if defined(COLORS)
// Second pass over the same fragments: those whose keys (A) were kept store their colours (C).
layout(std430, set = 0, binding = SLOT_A) readonly buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_C) writeonly buffer Colors { uint colors[]; };
void main() {
  const uint first = kK * fragment_pixel();
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (key > keys[first + kK - 1u]) return;
  for (uint i = 0u; i < kK; ++i) {
    if (keys[first + i] == key) {
      colors[first + i] = fragment_color();
      return;
    }
  }
}
#endif
