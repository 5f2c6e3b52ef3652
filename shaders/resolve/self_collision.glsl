// Shows where an object intersects itself: where a ray that is inside the object enters it again. At most 8
// objects.
//
// The first word has 4 bits per object: how often the ray is inside, plus 8. If faces are closer than the
// precision of depths, a ray may leave an object before it enters it; the counts still come out even. Counts
// beyond -8..7 wrap around. The second word has the fronts at the depth of the third word. They count only
// when that depth is left, so that parts that merely touch do not collide. The fourth word has the nearest
// colour; bit 31 says that a collision was found.
State self_collision_init() { return State(vec4(0.0), uvec4(0x88888888u, 0u, kNone, 0u)); }

// Handles all objects at once.
void self_collision_close(inout State s) {
  const uint entered = s.word.y;
  const uint some = (entered | entered >> 1 | entered >> 2 | entered >> 3) & 0x11111111u;
  s.word.x += entered;
  const uint twice = s.word.x >> 3 & (s.word.x >> 2 | s.word.x >> 1);  // lowest bit of a field: at least 10
  if ((twice & some) != 0u) s.word.w |= 0x80000000u;
  s.word.y = 0u;
}

void self_collision_fold(inout State s, Fragment f, bool enters, bool nearest) {
  if (floatBitsToUint(f.z) != s.word.z) {
    self_collision_close(s);
    s.word.z = floatBitsToUint(f.z);
  }
  const uint one = 1u << (4u * object_of(f.id));
  if (enters) {
    s.word.y += one;
  } else {
    s.word.x -= one;
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
