// A pool that is divided among pixels. D has the first place of the share of every pixel, and the end. If the
// places do not suffice for all pixels at once, a round handles only the pixels whose share lies in the
// window of push.p1 places from push.p0.
layout(std430, set = 0, binding = SLOT_D) readonly buffer Firsts { uint firsts[]; };
// The value of push.p2 in the last round.
const uint kLastRound = 1u;
// The value of kVariant if fragments that find no place are lost and counted. If the effect blends, they go
// to a tail.
const uint kLosesFragments = 1u;

struct Share {
  uint first, count;  // places of the pool
  bool in_window;
};
Share share_of(uint pixel) {
  const uint first = firsts[pixel];
  const uint count = firsts[pixel + 1u] - first;
  const bool in_window = first >= push.p0 && first + count <= push.p0 + push.p1;
  return Share(first - push.p0, count, in_window);
}
