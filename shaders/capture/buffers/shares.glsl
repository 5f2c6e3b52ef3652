// Places of a pool that is divided among pixels: D: the first place of every pixel's share, and the end. Where there are
// not places for all pixels at once, those take part whose share lies in the window of push.p1 places from push.p0.
layout(std430, set = 0, binding = SLOT_D) readonly buffer Firsts { uint firsts[]; };
// push.p2 of the last round.
const uint kLastRound = 1u;
// kVariant: fragments that find no place are lost, and counted; where the effect blends, they go to a tail.
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
