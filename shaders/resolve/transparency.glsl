// "Over": colour (premultiplied, linear) and the transmittance of what was folded. Wireframe differs only in the
// colours that its fragments come with.
State transparency_init() { return State(vec4(0.0, 0.0, 0.0, 1.0), uvec4(0u)); }

void transparency_step(inout State s, Fragment f) {
  const vec4 c = unpack_color(f.color);
  s.color.rgb += s.color.a * c.a * c.rgb;
  s.color.a *= 1.0 - c.a;
}

void transparency_step_back(inout State s, Fragment f) {
  const vec4 c = unpack_color(f.color);
  s.color.rgb = c.a * c.rgb + (1.0 - c.a) * s.color.rgb;
  s.color.a *= 1.0 - c.a;
}

void transparency_merge(inout State s, State behind) {
  s.color.rgb += s.color.a * behind.color.rgb;
  s.color.a *= behind.color.a;
}

vec4 transparency_finish(State s, uint pixel) {
  return vec4(s.color.rgb + s.color.a * background_of(pixel), 1.0 - s.color.a);
}
