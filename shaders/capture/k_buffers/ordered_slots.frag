#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Keeps the kK nearest fragments, three words each.
#include "capture/ordered_words.glsl"
#include "capture/insert_fragment.glsl"

void main() {
  EACH(LOAD)
  const uvec3 fragment = uvec3(floatBitsToUint(gl_FragCoord.z), fragment_id(), fragment_color());
  if (!is_before(fragment, slot_at(kK - 1u))) discard;
  insert_fragment(fragment);
  EACH(STORE)
}
