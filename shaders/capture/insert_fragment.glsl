// Insertion of a fragment (depth bits, id, colour) into the kK nearest of its pixel, which are sorted, where nobody else
// is at them: in order (k_buffers/ordered_slots.frag) or in a critical section (k_buffers/interlock_slots.frag). Returns what
// falls out at the end. Needs slot_at(i) and put_slot(i, f); SLOTS, a constant, is not less than kK.
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
