// An effect is a fold over the fragments of a pixel. Its functions are init, step (adds the next fragment
// behind), step_back (adds the next one in front, for techniques that come from the far end), merge (adds the
// state of what lies behind) and finish. Effects of more than a few lines have their own file. The constant
// kEffect chooses, so that a driver compiles only one of them.
#ifndef EFFECTS_GLSL
#define EFFECTS_GLSL
#include "scene/opaque.glsl"

// The state of a fold over the fragments of a pixel. Each effect defines what the members mean.
struct State {
  vec4 color;
  uvec4 word;
};
layout(std430, set = 0, binding = SLOT_OBJECTS) readonly buffer Objects { uint objects[]; };
uint object_of(uint id) { return objects[triangle_of(id)]; }

// The "over" operator: premultiplied linear colour, and the transmittance of what was folded. Wireframe
// differs only in the colours of its fragments.
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

#include "resolve/coplanarity.glsl"

// The number of fragments of the pixel, as a heat map in which each colour stands for twice as many as the
// one before. word.x is the number.
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

// The length of a ray inside closed solids: depths of back faces minus those of front faces, in units of the
// distance between the planes. It is shown as light that is absorbed. color.x is the sum, word.x the number
// of fragments.
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

#include "resolve/csg.glsl"
#include "resolve/self_collision.glsl"

// Every fragment as it was delivered, for tests, deep pixels and picking. The buffer has pixel_count() + 1
// offsets, then depth bits, id and colour of each fragment. word.x is the number so far. Fragments from the
// back fill the range from its end.
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

// The values of enum class Effect of include/pellucid/render_options.h.
const uint kTransparencyEffect = 0u;
const uint kWireframeEffect = 1u;
const uint kCsgEffect = 2u;
const uint kSelfCollisionEffect = 3u;
const uint kCoplanarityEffect = 4u;
const uint kComplexityEffect = 5u;
const uint kThicknessEffect = 6u;
const uint kDumpEffect = 7u;

// Returns whether the order of fragments at one depth matters.
bool effect_blends() { return kEffect <= kWireframeEffect; }

State effect_init() {
  if (kEffect == kCsgEffect) return csg_init();
  if (kEffect == kSelfCollisionEffect) return self_collision_init();
  if (kEffect == kCoplanarityEffect) return coplanarity_init();
  if (kEffect == kComplexityEffect) return complexity_init();
  if (kEffect == kThicknessEffect) return thickness_init();
  if (kEffect == kDumpEffect) return dump_init();
  return transparency_init();
}

void effect_step(inout State s, uint pixel, Fragment f) {
  if (kEffect == kCsgEffect) csg_step(s, f);
  else if (kEffect == kSelfCollisionEffect) self_collision_step(s, f);
  else if (kEffect == kCoplanarityEffect) coplanarity_step(s, f);
  else if (kEffect == kComplexityEffect) complexity_step(s, f);
  else if (kEffect == kThicknessEffect) thickness_step(s, f);
  else if (kEffect == kDumpEffect) dump_step(s, pixel, f);
  else transparency_step(s, f);
}

void effect_step_back(inout State s, uint pixel, Fragment f) {
  if (kEffect == kCsgEffect) csg_step_back(s, f);
  else if (kEffect == kSelfCollisionEffect) self_collision_step_back(s, f);
  else if (kEffect == kCoplanarityEffect) coplanarity_step(s, f);
  else if (kEffect == kComplexityEffect) complexity_step(s, f);
  else if (kEffect == kThicknessEffect) thickness_step(s, f);
  else if (kEffect == kDumpEffect) dump_step_back(s, pixel, f);
  else transparency_step_back(s, f);
}

void effect_merge(inout State s, State behind) {
  if (kEffect == kCsgEffect) csg_merge(s, behind);
  else if (kEffect == kSelfCollisionEffect) self_collision_merge(s, behind);
  else if (kEffect == kCoplanarityEffect) coplanarity_merge(s, behind);
  else if (kEffect == kComplexityEffect) complexity_merge(s, behind);
  else if (kEffect == kThicknessEffect) thickness_merge(s, behind);
  else if (kEffect <= kWireframeEffect) transparency_merge(s, behind);
}

vec4 effect_finish(State s, uint pixel) {
  if (kEffect == kCsgEffect) return csg_finish(s);
  if (kEffect == kSelfCollisionEffect) return self_collision_finish(s);
  if (kEffect == kCoplanarityEffect) return coplanarity_finish(s);
  if (kEffect == kComplexityEffect) return complexity_finish(s);
  if (kEffect == kThicknessEffect) return thickness_finish(s);
  if (kEffect == kDumpEffect) return vec4(0.0);
  return transparency_finish(s, pixel);
}

// Returns whether nothing behind can be seen, because what is left changes no 8-bit channel.
bool effect_is_done(State s) { return effect_blends() && s.color.a < 1.0 / 16384.0; }
#endif
