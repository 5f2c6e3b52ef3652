// Inserts a fragment into a place (places.glsl) whose first slot holds the farthest one. Needs a coherent
// buffer `words`, and counters.
#ifndef MAX_FIRST_GLSL
#define MAX_FIRST_GLSL
#include "capture/k_buffers/max_heap.glsl"
#ifndef ORDER_WORDS
#define ORDER_WORDS memoryBarrierBuffer();
#endif

// If every fragment has a slot, nobody waits: each takes the first free one.
void take_any_slot(Place place, uvec2 key) {
  for (uint i = place.first; i < place.first + place.keys; ++i) {
    if (words[2u * i + 1u] != kNone || atomicCompSwap(words[2u * i + 1u], kNone, key.x) != kNone) continue;
    words[2u * i] = key.y;
    return;
  }
}

// The farthest only gets nearer. Without the lock, its depth may therefore reject a fragment, but not admit
// one.
bool is_rejected(Place place, uvec2 key) { return key.x > (words[2u * place.first + 1u] & ~kUnlocked); }

// Inserts the key, in the critical section. Returns the farthest key afterwards.
uvec2 insert(Place place, uvec2 key) {
  const uvec2 farthest = key_at(place.first);
  if (!is_behind(farthest, key)) return farthest;
  return place.keys >= kK ? sift_down(place.first, place.keys, 0u, key) : replace_first(place.first, place.keys, key);
}

// The word with the depth of the farthest is also the lock. Clearing its top bit takes the lock, and storing
// the new depth with the bit set releases it.
bool insert_alone(Place place, uvec2 key) {
  const uint lock = 2u * place.first + 1u;
  if ((atomicAnd(words[lock], ~kUnlocked) & kUnlocked) == 0u) return false;
  ORDER_WORDS
  const uvec2 farthest = insert(place, key);
  words[lock - 1u] = farthest.y;
  ORDER_WORDS
  atomicExchange(words[lock], farthest.x | kUnlocked);
  return true;
}

// Tries push.p2 times. A fragment that is still waiting then goes to the tail and is counted. The critical
// section lies within the turn that gets the lock, so invocations that run in lockstep do not wait for each
// other.
void insert_in_turn(Place place, uvec2 key) {
  bool waits = true;
  for (uint turn = 0u; turn < push.p2 && waits; ++turn)
    waits = !is_rejected(place, key) && !insert_alone(place, key);
  if (waits && !is_rejected(place, key)) atomicAdd(counters.overflowed, 1u);
}
#endif
