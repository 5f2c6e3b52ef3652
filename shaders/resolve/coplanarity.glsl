// The largest group of fragments at one depth, in the colours of figure 13 of Vasilakis and Fudos 2014. word
// has the depth of the last group (bits), its size, the largest size, and the number of fragments in groups
// of two or more.
State coplanarity_init() { return State(vec4(0.0), uvec4(kNone, 0u, 0u, 0u)); }

void coplanarity_step(inout State s, Fragment f) {
  const uint depth = floatBitsToUint(f.z);
  if (depth == s.word.x) {
    ++s.word.y;
    s.word.w += s.word.y == 2u ? 2u : 1u;
  } else {
    s.word.x = depth;
    s.word.y = 1u;
  }
  s.word.z = max(s.word.z, s.word.y);
}

// Both ends may have met inside a group.
void coplanarity_merge(inout State s, State behind) {
  s.word.w += behind.word.w;
  if (s.word.x == behind.word.x && s.word.y > 0u && behind.word.y > 0u) {
    s.word.w += (s.word.y == 1u ? 1u : 0u) + (behind.word.y == 1u ? 1u : 0u);
    s.word.z = max(s.word.z, s.word.y + behind.word.y);
  }
  s.word.z = max(s.word.z, behind.word.z);
}

vec4 coplanarity_finish(State s) {
  if (s.word.z == 0u) return vec4(frame.background.rgb, 0.0);
  const vec3 colors[9] = vec3[](vec3(0.22), vec3(0.8, 0.02, 0.02), vec3(0.02, 0.05, 0.8), vec3(0.02, 0.45, 0.05),
                                vec3(0.0, 0.75, 0.75), vec3(0.2, 1.0, 0.65), vec3(0.9, 0.0, 0.9), vec3(0.95, 0.9, 0.0),
                                vec3(0.3, 0.12, 0.02));
  return vec4(colors[min(s.word.z, 9u) - 1u], 1.0);
}
