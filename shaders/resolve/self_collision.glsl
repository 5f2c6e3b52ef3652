// Where an object runs through itself: a ray that is inside of it enters it once more. At most 8 objects.
// word: how often inside (4 bits an object); the same for fronts at the depth word.z, which count once that depth
// is left, so that parts that only touch do not collide; the nearest colour, bit 31: a collision was found.
State self_collision_init() { return State(vec4(0.0), uvec4(0u, 0u, kNone, 0u)); }

void self_collision_close(inout State s) {
  for (uint object = 0u; object < 8u; ++object) {
    const uint entered = bitfieldExtract(s.word.y, int(4u * object), 4);
    if (entered == 0u) continue;
    const uint inside = bitfieldExtract(s.word.x, int(4u * object), 4);
    if (inside + entered >= 2u) s.word.w |= 0x80000000u;
    s.word.x = bitfieldInsert(s.word.x, min(inside + entered, 15u), int(4u * object), 4);
  }
  s.word.y = 0u;
}

void self_collision_fold(inout State s, Fragment f, bool enters, bool nearest) {
  if (floatBitsToUint(f.z) != s.word.z) {
    self_collision_close(s);
    s.word.z = floatBitsToUint(f.z);
  }
  const int shift = int(4u * object_of(f.id));
  if (enters) {
    s.word.y = bitfieldInsert(s.word.y, min(bitfieldExtract(s.word.y, shift, 4) + 1u, 15u), shift, 4);
  } else if (bitfieldExtract(s.word.x, shift, 4) > 0u) {
    s.word.x = bitfieldInsert(s.word.x, bitfieldExtract(s.word.x, shift, 4) - 1u, shift, 4);
  }
  if (nearest) s.word.w = (s.word.w & 0x80000000u) | 0x40000000u | (f.color & 0x00FFFFFFu);
}

void self_collision_step(inout State s, Fragment f) {
  self_collision_fold(s, f, !is_back(f.id), (s.word.w & 0x40000000u) == 0u);
}
void self_collision_step_back(inout State s, Fragment f) { self_collision_fold(s, f, is_back(f.id), true); }

void self_collision_merge(inout State s, State behind) {
  self_collision_close(s);
  self_collision_close(behind);
  if ((s.word.w & 0x40000000u) == 0u) s.word.w |= behind.word.w;
  s.word.w |= behind.word.w & 0x80000000u;
}

vec4 self_collision_finish(State s) {
  self_collision_close(s);
  if ((s.word.w & 0x40000000u) == 0u) return vec4(frame.background.rgb, 0.0);
  const vec3 color = unpack_color(s.word.w & 0x00FFFFFFu).rgb;
  const float gray = dot(color, vec3(0.2126, 0.7152, 0.0722));
  return vec4((s.word.w & 0x80000000u) != 0u ? vec3(0.25 + 0.6 * gray, 0.02, 0.02) : vec3(0.15 + 0.7 * gray), 1.0);
}
