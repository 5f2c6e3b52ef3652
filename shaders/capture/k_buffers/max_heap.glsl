// The fragments of a place as an array or a heap whose first slot holds the farthest, for one invocation at a
// time. Needs a buffer `words`. Keys are (depth bits, id), compared in this order. The key of an empty slot
// is greater than all others.
//
// The top bit of the depth of the first slot is a lock (max_first.frag). If it is set, as in an empty slot,
// the lock is free.
#ifndef MAX_HEAP_GLSL
#define MAX_HEAP_GLSL
const uint kUnlocked = kHasColor;
uvec2 key_at(uint slot) { return uvec2(words[2u * slot + 1u] & ~kUnlocked, words[2u * slot]); }
void put_key(uint slot, uvec2 key) {
  words[2u * slot] = key.y;
  words[2u * slot + 1u] = key.x == ~kUnlocked ? kNone : key.x;
}
bool is_behind(uvec2 a, uvec2 b) { return a.x > b.x || (a.x == b.x && a.y > b.y); }

// Puts a key into position `at` of a heap of `count`, or into the position of the farthest key below it; the
// keys on the way move up. The key for position `at` is not stored but returned.
uvec2 sift_down(uint first, uint count, uint at, uvec2 key) {
  const uint top = at;
  uvec2 farthest = key;
  for (uint child = 2u * at + 1u; child < count; child = 2u * at + 1u) {
    uvec2 below = key_at(first + child);
    if (child + 1u < count) {
      const uvec2 other = key_at(first + child + 1u);
      if (is_behind(other, below)) {
        below = other;
        ++child;
      }
    }
    if (!is_behind(below, key)) break;
    if (at == top) farthest = below;
    else put_key(first + at, below);
    at = child;
  }
  if (at != top) put_key(first + at, key);
  return farthest;
}

// Replaces the first key of an array, the farthest, by a new key. Returns the key that is the farthest then;
// it is not stored.
uvec2 replace_first(uint first, uint count, uvec2 key) {
  uvec2 farthest = key;
  uint found = 0u;
  for (uint i = 1u; i < count && farthest.x != ~kUnlocked; ++i) {
    const uvec2 here = key_at(first + i);
    if (!is_behind(here, farthest)) continue;
    farthest = here;
    found = i;
  }
  if (found > 0u) put_key(first + found, key);
  return farthest;
}
#endif
