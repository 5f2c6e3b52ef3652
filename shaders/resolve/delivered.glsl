// What a round delivered at an end of a pixel, in sequence: see capture/layers.glsl. next_delivered() gives
// the one behind (at the far end: in front of) the `count` it gave so far, the last of them `last`.
#if defined(IMAGE)
layout(set = 0, binding = SLOT_IMAGE_2) uniform utexture2D found;
bool next_delivered(uint end, ivec2 pixel, bool far, uint count, uint last, inout Fragment f) {
  if (count > 0u) return false;
  const uvec2 texel = texelFetch(found, pixel, 0).xy;
  f.id = texel.x;
  f.color = texel.y;
  return texel.x != 0u;
}
#elif defined(CHAINS)
bool next_delivered(uint end, ivec2 pixel, bool far, uint count, uint last, inout Fragment f) {
  if (count >= kK) return false;
  const uint64_t node = chains[kK * end + count];
  const uint id = uint(node >> 32);
  f.id = far ? ~id : id;
  f.color = uint(node);
  return node != kEmpty;
}
#elif defined(LISTS) || defined(ARRAYS)
// Groups at one depth are short: the next one is searched for among all. A driver may end all loops of an
// invocation after a number of turns: push.p0 says how many there may be, and what is not reached is counted.
uint turns = 0u;
uint group_length = 0u;

#if defined(LISTS)
uint length_of(uint end) {
  uint count = 0u;
  for (uint node = heads[end]; node != kNone; node = nodes[3u * node + 2u]) ++count;
  return count;
}
#else
uint length_of(uint end) { return min(counts[end], kK); }
#endif

bool next_delivered(uint end, ivec2 pixel, bool far, uint count, uint last, inout Fragment f) {
  if (count == 0u) {
    group_length = length_of(end);
    turns += group_length;
  }
  turns += group_length + 1u;
  if (turns > push.p0) return false;
  f.id = far ? 0u : kNone;
#if defined(LISTS)
  for (uint at = heads[end]; at != kNone; at = nodes[3u * at + 2u]) {
    const uvec2 node = uvec2(nodes[3u * at], nodes[3u * at + 1u]);
#else
  for (uint at = 0u; at < min(counts[end], kK); ++at) {
    const uvec2 node = nodes[kK * end + at];
#endif
    const bool is_next = far ? (count == 0u || node.x < last) && node.x > f.id
                             : (count == 0u || node.x > last) && node.x < f.id;
    if (!is_next) continue;
    f.id = node.x;
    f.color = node.y;
  }
  return f.id != (far ? 0u : kNone);
}
#endif
