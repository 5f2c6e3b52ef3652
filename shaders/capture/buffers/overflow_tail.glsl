// Fragments that did not fit, as one translucent layer behind the rest: the weighted average of their
// colours, with the product of their transmittances. Sums are integers, so the order of fragments does not
// matter. E has five words per pixel. push.p3 is the number of units in 1. Based on: Maule, Comba,
// Torchelsen, Bastos, "Hybrid Transparency", I3D 2013.
layout(std430, set = 0, binding = SLOT_E) buffer Tail { uint tail[]; };
const uint kTailWords = 5u;  // opacity times red, green, blue; opacity; -log2 of transmittance
const float kMostAbsorption = 16.0;

void add_to_tail(uint pixel, vec4 color) {
  const float unit = float(push.p3);
  const uint at = kTailWords * pixel;
  atomicAdd(tail[at], uint(round(unit * color.a * color.r)));
  atomicAdd(tail[at + 1u], uint(round(unit * color.a * color.g)));
  atomicAdd(tail[at + 2u], uint(round(unit * color.a * color.b)));
  atomicAdd(tail[at + 3u], uint(round(unit * color.a)));
  const float absorption = color.a < 1.0 ? min(-log2(1.0 - color.a), kMostAbsorption) : kMostAbsorption;
  atomicAdd(tail[at + 4u], uint(round(unit * absorption)));
}

// Returns the premultiplied colour and the transmittance of the tail.
vec4 tail_layer(uint pixel) {
  const uint at = kTailWords * pixel;
  if (tail[at + 3u] == 0u) return vec4(0.0, 0.0, 0.0, 1.0);
  const float absorption = float(tail[at + 4u]) / float(push.p3);
  const float transmittance = exp2(-absorption);
  const vec3 average = vec3(tail[at], tail[at + 1u], tail[at + 2u]) / float(tail[at + 3u]);
  return vec4((1.0 - transmittance) * average, transmittance);
}
