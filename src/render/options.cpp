// Implements options.h: names of option values (effects, ways of synchronisation, terms of importance), and
// checks of their ranges.
#include "render/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
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

std::span<const NamedSync> sync_ways() {
  static const std::vector<NamedSync> kWays{{Sync::ordered, "ordered"},
                                            {Sync::interlock, "interlock"},
                                            {Sync::atomics, "atomics"},
                                            {Sync::atomics32, "atomics32"},
                                            {Sync::spinlock, "spinlock"}};
  return kWays;
}

std::string missing_for(Sync sync, const DeviceInfo& device) {
  if (sync == Sync::atomics && !device.atomics64) return "64-bit atomics";
  if (sync == Sync::interlock && !device.interlock) return "VK_EXT_fragment_shader_interlock";
  if (sync == Sync::ordered && device.ordered_attachments == 0)
    return "VK_EXT_rasterization_order_attachment_access";
  return "";
}

std::span<const NamedImportanceTerm> importance_terms() {
  static const std::array<NamedImportanceTerm, 6> kTerms{
      {{ImportanceTerm::opacity, "opacity", "the fewer, the more opaque its fragments are"},
       {ImportanceTerm::complexity, "complexity", "by its number of fragments"},
       {ImportanceTerm::periphery, "periphery", "by the distance from a point of interest"},
       {ImportanceTerm::fresnel, "fresnel", "less where the nearest surface is seen at a grazing angle"},
       {ImportanceTerm::image, "image", "by an image"},
       {ImportanceTerm::residue, "residue", "by what the last frame left to the tail"}}};
  return kTerms;
}

namespace render {

void check_effect(Effect effect, std::size_t objects) {
  std::size_t most = std::numeric_limits<std::size_t>::max();
  if (effect == Effect::csg) most = 32;
  if (effect == Effect::self_collision) most = 8;
  if (objects <= most) return;
  throw Error(ErrorKind::bad_argument,
              fmt::format("effect {}: at most {} objects can be told apart, and the scene has {}",
                          render_effects()[static_cast<std::size_t>(effect)].name, most, objects));
}

bool cuts_solids(Effect effect) {
  return effect == Effect::csg || effect == Effect::self_collision || effect == Effect::thickness;
}

bool blends(Effect effect) {
  return effect == Effect::transparency || effect == Effect::wireframe;
}

void check_importance(const ImportanceOptions& options) {
  const auto require = [](bool right, const char* what) {
    if (!right) throw Error(ErrorKind::bad_argument, what);
  };
  require(options.alpha >= 0 && options.alpha <= 1, "importance by complexity: alpha is not in 0..1");
  require(options.limit > 0 && std::isfinite(options.limit),
          "importance by complexity: the limit is not a positive number");
  require(std::isfinite(options.focus_x) && std::isfinite(options.focus_y),
          "importance by periphery: the focus is not two numbers");
  require(options.falloff > 0 && std::isfinite(options.falloff),
          "importance by periphery: the falloff is not a positive number");
  require(options.noise >= 0 && options.noise <= 1, "noise of importance: not in 0..1");
  if (std::find(options.terms.begin(), options.terms.end(), ImportanceTerm::image) == options.terms.end())
    return;
  const ImportanceImage& image = options.image;
  require(!image.bytes.empty() && image.bytes.size() == std::uint64_t{image.width} * image.height,
          "terms of importance: there is no importance image, or it does not have one byte a pixel");
}

}  // namespace render
}  // namespace pellucid
