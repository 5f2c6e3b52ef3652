// Names of effects: see effects.h.
#include "render/effects.h"

#include <fmt/format.h>

#include <array>
#include <limits>

namespace pellucid {

std::span<const NamedEffect> render_effects() {
  static const std::array<NamedEffect, 7> kEffects{
      {{Effect::transparency, "transparency", "all surfaces blended in depth order"},
       {Effect::wireframe, "wireframe", "the same with opaque edges, hidden ones too"},
       {Effect::csg, "csg", "union, intersection or difference of closed solids"},
       {Effect::self_collision, "self-collision", "where an object runs through itself, in red"},
       {Effect::coplanarity, "coplanarity", "how many fragments share a depth"},
       {Effect::complexity, "complexity", "how many fragments a pixel has"},
       {Effect::thickness, "thickness", "how much of closed solids light goes through"}}};
  return kEffects;
}

namespace render {

void check_effect(Effect effect, std::size_t objects) {
  std::size_t most = std::numeric_limits<std::size_t>::max();
  if (effect == Effect::csg) most = 32;
  if (effect == Effect::self_collision) most = 8;
  if (objects <= most) return;
  throw Error(ErrorKind::bad_argument,
              fmt::format("--effect {}: at most {} objects can be told apart, the scene has {}",
                          render_effects()[static_cast<std::size_t>(effect)].name, most, objects));
}

bool blends(Effect effect) {
  return effect == Effect::transparency || effect == Effect::wireframe;
}

}  // namespace render
}  // namespace pellucid
