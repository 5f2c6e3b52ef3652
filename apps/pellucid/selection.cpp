// Implements selection.h: the choice of primitives.
#include "selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace pellucid::cli {
namespace {

void check_material(const Model& model, const std::string& name) {
  const bool known = std::any_of(model.primitives.begin(), model.primitives.end(),
                                 [&](const Primitive& p) { return p.material_name == name; });
  if (!known)
    throw Error(ErrorKind::bad_argument, fmt::format("{}: no material named '{}'", model.path, name));
}

}  // namespace

Selection select_primitives(const Model& model, const SelectionOptions& options) {
  if (!options.material.empty()) check_material(model, options.material);
  Selection selection;
  std::vector<std::uint32_t> orderable;
  std::uint64_t not_triangles = 0;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i) {
    const Primitive& primitive = model.primitives[i];
    if (!options.material.empty() && primitive.material_name != options.material) continue;
    if (!primitive.triangles || primitive.mesh.triangles.empty()) {
      ++not_triangles;
    } else if (primitive.deforms) {
      selection.notes.push_back(primitive.name +
                                ": skinned or morphed, static orders do not hold: left as it is");
    } else {
      orderable.push_back(i);
    }
  }
  if (not_triangles > 0) {
    selection.notes.push_back(
        fmt::format("{} primitive(s) without triangles: left as they are", not_triangles));
  }

  // By default, only primitives that are drawn with blending are ordered.
  if (options.all || !options.material.empty()) {
    selection.primitives = std::move(orderable);
  } else {
    std::copy_if(orderable.begin(), orderable.end(), std::back_inserter(selection.primitives),
                 [&](std::uint32_t i) { return model.primitives[i].alpha_mode == AlphaMode::blend; });
    if (selection.primitives.empty() && !orderable.empty()) {
      selection.notes.emplace_back("no primitive is drawn with alphaMode BLEND: ordering all of them");
      selection.primitives = std::move(orderable);
    } else if (selection.primitives.size() < orderable.size()) {
      selection.notes.push_back(
          fmt::format("{} primitive(s) are not BLEND: left as they are (--all orders them too)",
                      orderable.size() - selection.primitives.size()));
    }
  }
  if (selection.primitives.empty()) {
    std::string reason = "there are no triangles in it";
    if (!selection.notes.empty()) reason = selection.notes.front();
    throw Error(ErrorKind::nothing_to_do, fmt::format("{}: nothing to order: {}", model.path, reason));
  }
  return selection;
}

}  // namespace pellucid::cli
