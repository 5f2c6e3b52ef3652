// Every fragment as it was delivered, for tests, deep pixels and picking: pixel_count() + 1 offsets, then depth
// bits, id and colour of each. word.x: how many so far. Those from the back fill from the end.
layout(std430, set = 0, binding = SLOT_DUMP) buffer Dump { uint dump[]; };

State dump_init() { return State(vec4(0.0), uvec4(0u)); }

void dump_write(uint place, Fragment f) {
  const uint at = pixel_count() + 1u + 3u * place;
  dump[at] = floatBitsToUint(f.z);
  dump[at + 1u] = f.id;
  dump[at + 2u] = f.color;
}
void dump_step(inout State s, uint pixel, Fragment f) {
  const uint place = dump[pixel] + s.word.x++;
  if (place < dump[pixel + 1u]) dump_write(place, f);
}
void dump_step_back(inout State s, uint pixel, Fragment f) {
  const uint place = dump[pixel + 1u] - 1u - s.word.x++;
  if (place >= dump[pixel]) dump_write(place, f);
}
