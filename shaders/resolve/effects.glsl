// An effect is a fold over a pixel's fragments: init, step (the next one behind), step_back (the next one in front,
// for techniques that come from the far end), merge (what lies behind), finish. One file each; this one chooses by
// the constant kEffect, so that a driver keeps one of them.
#ifndef EFFECTS_GLSL
#define EFFECTS_GLSL
#include "../interface/opaque.glsl"
#include "state.glsl"
#include "transparency.glsl"
#include "coplanarity.glsl"
#include "complexity.glsl"
#include "thickness.glsl"
#include "csg.glsl"
#include "self_collision.glsl"
#include "dump.glsl"

// src/render/effects.h: enum class Effect.
const uint kTransparencyEffect = 0u;
const uint kWireframeEffect = 1u;
const uint kCsgEffect = 2u;
const uint kSelfCollisionEffect = 3u;
const uint kCoplanarityEffect = 4u;
const uint kComplexityEffect = 5u;
const uint kThicknessEffect = 6u;
const uint kDumpEffect = 7u;

// Does the sequence of fragments at one depth matter?
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

// Nothing behind can be seen: what is left changes no channel of eight bits.
bool effect_is_done(State s) { return effect_blends() && s.color.a < 1.0 / 16384.0; }
#endif
