// What fixed-k and hybrid keep in ordered attachments, in words that are cleared to kNone. First come kK
// sorted slots (depth bits, id, colour). Then come the sums of the tail, which begin at -1: red, green, blue,
// weight and, if opacities are the weights, optical depth. push.p1 is the range of the sums (tail.glsl).
#ifndef CORE_LAYERS_GLSL
#define CORE_LAYERS_GLSL
#include "capture/k_buffers/tail.glsl"
const uint kTailWord = 3u * kK;
const bool kByOpacity = kVariant == 3u;  // Places::uniform_by_opacity
const uint kSumWords = kByOpacity ? 5u : 4u;
float sum_scale() { return tail_scale(32u, push.p1); }
#endif
