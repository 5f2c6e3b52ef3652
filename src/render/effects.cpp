// Names of effects: see effects.h.
#include "effects.h"

#include <array>
#include <limits>

namespace pellucid {

std::span<const NamedEffect> render_effects() {
  static const std::array<NamedEffect, 7> effects{
      {{Effect::transparency, "transparency", "all surfaces blended in depth order"},
       {Effect::wireframe, "wireframe", "the same with opaque edges, hidden ones too"},
       {Effect::csg, "csg", "union, intersection or difference of closed solids"},
       {Effect::self_collision, "self-collision", "where an object runs through itself, in red"},
       {Effect::coplanarity, "coplanarity", "how many fragments share a depth"},
       {Effect::complexity, "complexity", "how many fragments a pixel has"},
       {Effect::thickness, "thickness", "how much of closed solids light goes through"}}};
  return effects;
}

namespace render {

std::uint32_t most_objects(Effect effect) {
  if (effect == Effect::csg) return 32;
  if (effect == Effect::self_collision) return 8;
  return std::numeric_limits<std::uint32_t>::max();
}

}  // namespace render
}  // namespace pellucid
