#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/k_buffers/place_tail.glsl"
#include "capture/k_buffers/slots.glsl"
// Last pass over the same fragments: if the key of a fragment was kept, its colour replaces its id. A mark
// keeps the colour from being taken for the id of a fragment at the same depth. All other fragments go to the
// tail.
const uint kDump = 7u;  // kDumpEffect, which wants the ids

void main() {
  const uint pixel = fragment_pixel();
  const Place place = place_of(pixel);
  const uint depth = floatBitsToUint(gl_FragCoord.z);
  const uint id = fragment_id();
  const uint behind = place.first + place.keys;
  const uint slot = slot_of(place, depth, id);
  if (slot < behind) {
    if (kEffect != kDump) put_color(slot, depth, fragment_color());
    return;
  }
  if (kEffect == kDump || place.tail == 0u) return;
  // At most 1, in case the last slot is empty.
  const float last = place.keys > 0u ? uintBitsToFloat(min(depth_at(behind - 1u), floatBitsToUint(1.0))) : 0.0;
  const float rounding = tail_rounding(pixel, id);
  const uint color = fragment_color();
  if (kVariant == kUniformWithOpacities) {
    add_to_slot(behind, units_by_opacity(color, place, rounding));
    add_to_slot(behind + 1u, units_of_depth(color, place, rounding));
  } else {
    add_to_slot(behind, units_in_place(place, color, gl_FragCoord.z, last, rounding));
  }
}
