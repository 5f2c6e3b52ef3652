// What the ordered k-buffer keeps of a pixel, in words of attachments that are cleared to kNone.
//
// First the window: kK slots (~depth bits, ~id, colour). With keys turned over like this, those of free slots, kNone, are
// in front of all others: sorted, the farthest comes first, free slots last, and what falls out when one is inserted is a
// free slot as long as there is one, the nearest fragment from then on.
#ifndef ORDERED_WINDOW_GLSL
#define ORDERED_WINDOW_GLSL
bool is_free(uvec3 slot) { return slot.y == kNone; }
// Then what was blended: premultiplied colour and transmittance, as bits of floats...
const uint kBlendedWord = 3u * kK;
// ...the key of the farthest, turned over, kNone: nothing was blended...
const uint kFarthestWord = kBlendedWord + 4u;
// ...and kNone as long as none came when a farther one had been blended.
const uint kLateWord = kBlendedWord + 6u;

const vec4 kNothingBlended = vec4(0.0, 0.0, 0.0, 1.0);

vec4 blended_under(vec4 before, uint color) {
  const vec4 c = unpack_color(color);
  return vec4(before.rgb + before.a * c.a * c.rgb, before.a * (1.0 - c.a));
}
#endif
