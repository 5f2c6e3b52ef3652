// Insertion into the slots of a place by minima of 32 bits, first of depths, then of ids; needs slots.glsl as HALVES.
// Chains as of capture/insert_key.glsl. As a slot only ever gets smaller, and in the end they increase, a depth may begin
// behind any slot that is not farther.

// Depths stay as often as there are fragments at them.
void insert_depth(Place place, uint depth) {
  if (place.keys == 0u) return;
  const uint last = place.first + place.keys - 1u;
  if (depth >= words[2u * last + 1u]) return;
  uint begin = place.first;
  for (uint end = last; begin < end;) {
    const uint middle = (begin + end) / 2u;
    if (words[2u * middle + 1u] <= depth) begin = middle + 1u;
    else end = middle;
  }
  for (uint i = begin; i <= last && depth != kNone; ++i) depth = max(depth, atomicMin(words[2u * i + 1u], depth));
}

// When all depths are there: of the fragments at one, the smallest ids, as many as it has slots.
void insert_id(Place place, uint depth, uint id) {
  const uint behind = place.first + place.keys;
  for (uint i = first_slot_at(place, depth); i < behind && id != kNone && depth_at(i) == depth; ++i)
    id = max(id, atomicMin(words[2u * i], id));
}
