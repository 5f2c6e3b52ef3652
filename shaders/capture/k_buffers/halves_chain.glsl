// Inserts fragments into the slots of a place by 32-bit minima, first depths, then ids. Needs slots.glsl with
// HALVES. The chains work as in capture/insert_key.glsl. Slots only get smaller, and they increase in the
// end, so a depth may skip every slot that is not farther.

// A depth is kept once for each fragment at it.
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

// Called when all depths are known. Of the fragments at one depth it keeps the smallest ids, as many as there
// are slots with this depth.
void insert_id(Place place, uint depth, uint id) {
  const uint behind = place.first + place.keys;
  for (uint i = first_slot_at(place, depth); i < behind && id != kNone && depth_at(i) == depth; ++i)
    id = max(id, atomicMin(words[2u * i], id));
}
