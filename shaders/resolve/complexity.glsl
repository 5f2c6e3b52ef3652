// Fragments of the pixel, as a heat map that doubles from colour to colour. word.x: their number.
State complexity_init() { return State(vec4(0.0), uvec4(0u)); }
void complexity_step(inout State s, Fragment f) { ++s.word.x; }
void complexity_merge(inout State s, State behind) { s.word.x += behind.word.x; }
vec4 complexity_finish(State s) {
  if (s.word.x == 0u) return vec4(frame.background.rgb, 0.0);
  const vec3 ramp[8] = vec3[](vec3(0.02, 0.03, 0.20), vec3(0.03, 0.12, 0.55), vec3(0.02, 0.40, 0.55), vec3(0.05, 0.55, 0.15),
                              vec3(0.75, 0.70, 0.03), vec3(0.90, 0.30, 0.02), vec3(0.70, 0.02, 0.05), vec3(0.95, 0.75, 0.85));
  const float place = clamp(log2(float(s.word.x)), 0.0, 6.999);
  const uint from = uint(place);
  return vec4(mix(ramp[from], ramp[from + 1u], place - float(from)), 1.0);
}
