// How much of closed solids a ray goes through: backs minus fronts, in units of the distance between the planes,
// shown as light that is absorbed. color.x: the sum; word.x: fragments.
State thickness_init() { return State(vec4(0.0), uvec4(0u)); }
void thickness_step(inout State s, Fragment f) {
  const float d = (view_distance(f.z) - frame.planes.x) / (frame.planes.y - frame.planes.x);
  s.color.x += is_back(f.id) ? d : -d;
  ++s.word.x;
}
void thickness_merge(inout State s, State behind) {
  s.color.x += behind.color.x;
  s.word.x += behind.word.x;
}
vec4 thickness_finish(State s) {
  if (s.word.x == 0u) return vec4(frame.background.rgb, 0.0);
  return vec4(frame.background.rgb * exp(-max(s.color.x, 0.0) * vec3(9.0, 4.5, 1.8)), 1.0);
}
