// Boolean operations on at most 32 closed solids. A ray is inside an object after an odd number of its faces.
// The surface is where the value of the operation changes. Faces at one depth are crossed together, so that
// coplanar faces neither vanish nor appear twice. word has one bit per object (inside), the depth of the open
// group (bits), the colour of the group with the value before it in bit 24, and the surface that was found
// (0: none).
// Faces that lie in one plane but are cut into different triangles get depths that differ by rounding, so depths
// count as one within kSkin steps of float32 (about 2e-6 of the depth range).
const uint kSkin = 32u;
bool csg_is_same_depth(uint a, uint b) {
  return a != kNone && b != kNone && max(a, b) - min(a, b) <= kSkin;
}
State csg_init() { return State(vec4(0.0), uvec4(0u, kNone, 0u, 0u)); }

bool csg_value(uint inside) {
  const uint all = frame.objects >= 32u ? 0xFFFFFFFFu : (1u << frame.objects) - 1u;
  if (frame.csg == 0u) return inside != 0u;
  if (frame.csg == 1u) return inside == all;
  return inside == 1u;  // the first object without the others
}

void csg_close(inout State s, bool nearest_last) {
  const bool was = (s.word.z & 0x01000000u) != 0u;
  if (s.word.y == kNone || csg_value(s.word.x) == was) return;
  if (s.word.w == 0u || nearest_last) s.word.w = s.word.z | 0xFF000000u;
}

void csg_fold(inout State s, Fragment f, bool nearest_last) {
  const uint depth = floatBitsToUint(f.z);
  if (!csg_is_same_depth(depth, s.word.y)) {
    csg_close(s, nearest_last);
    s.word.y = depth;
    s.word.z = (f.color & 0x00FFFFFFu) | (csg_value(s.word.x) ? 0x01000000u : 0u);
  } else if (nearest_last) {
    s.word.z = (f.color & 0x00FFFFFFu) | (s.word.z & 0x01000000u);
  }
  s.word.x ^= 1u << object_of(f.id);
}

void csg_step(inout State s, Fragment f) { csg_fold(s, f, false); }
void csg_step_back(inout State s, Fragment f) { csg_fold(s, f, true); }

// If both ends have a part of the same group, it is crossed as one. It is the last group of either end.
void csg_merge(inout State s, State behind) {
  if (csg_is_same_depth(s.word.y, behind.word.y)) {
    s.word.x ^= behind.word.x;  // the value behind the group, seen from the front, is the value before it from behind
    const bool was = (s.word.z & 0x01000000u) != 0u;
    const bool is = (behind.word.z & 0x01000000u) != 0u;
    if (s.word.w == 0u && was != is) s.word.w = s.word.z | 0xFF000000u;
  } else {
    csg_close(s, false);
    csg_close(behind, true);
  }
  if (s.word.w == 0u) s.word.w = behind.word.w;
  s.word.y = kNone;
}

vec4 csg_finish(State s) {
  csg_close(s, false);
  if (s.word.w == 0u) return vec4(frame.background.rgb, 0.0);
  return vec4(unpack_color(s.word.w).rgb, 1.0);
}
