// What the ordered k-buffer keeps of a pixel, in words of attachments that are cleared to kNone.
//
// The first words are the window: kK slots (~depth bits, ~id, colour). The keys are complemented, so the key
// kNone of a free slot is in front of all others. Sorted in this way, the farthest fragment comes first and
// free slots come last. An insertion pushes out a free slot as long as there is one, and afterwards the
// nearest fragment.
#ifndef ORDERED_WINDOW_GLSL
#define ORDERED_WINDOW_GLSL
bool is_free(uvec3 slot) { return slot.y == kNone; }
// Then comes what was blended: premultiplied colour and transmittance, as bits of floats.
const uint kBlendedWord = 3u * kK;
// Then comes the complemented key of the farthest blended fragment, or kNone if nothing was blended.
const uint kFarthestWord = kBlendedWord + 4u;
// The last word is kNone as long as no fragment came after a farther one had been blended.
const uint kLateWord = kBlendedWord + 6u;

const vec4 kNothingBlended = vec4(0.0, 0.0, 0.0, 1.0);

vec4 blended_under(vec4 before, uint color) {
  const vec4 c = unpack_color(color);
  return vec4(before.rgb + before.a * c.a * c.rgb, before.a * (1.0 - c.a));
}
#endif
