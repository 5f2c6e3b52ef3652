// Inserts a fragment (depth bits, id, colour) into the sorted kK nearest of its pixel, and returns the one
// that falls out at the end. No other invocation may access them at the same time: fragments run in draw
// order (k_buffers/ordered_slots.frag) or in a critical section (k_buffers/interlock_slots.frag). Needs
// slot_at(i), put_slot(i, f) and the constant SLOTS, which must not be less than kK.
bool is_before(uvec3 a, uvec3 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

uvec3 insert_fragment(uvec3 carried) {
  for (uint i = 0u; i < SLOTS; ++i) {
    if (i >= kK) break;
    const uvec3 here = slot_at(i);
    const bool nearer = is_before(carried, here);
    if (nearer) put_slot(i, carried);
    carried = nearer ? here : carried;
  }
  return carried;
}
