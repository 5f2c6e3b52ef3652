// Terms of importance and their parameters: see pellucid/budget.h.
#include "render/importance_terms.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pellucid {

std::span<const NamedImportanceTerm> importance_terms() {
  static const std::array<NamedImportanceTerm, 6> kTerms{
      {{ImportanceTerm::opacity, "opacity", "the fewer, the more opaque its fragments are"},
       {ImportanceTerm::complexity, "complexity", "by its number of fragments"},
       {ImportanceTerm::periphery, "periphery", "by the distance from a point of interest"},
       {ImportanceTerm::fresnel, "fresnel", "less where the nearest surface is seen at a grazing angle"},
       {ImportanceTerm::image, "image", "as a picture says"},
       {ImportanceTerm::residue, "residue", "by what the last frame left to the tail"}}};
  return kTerms;
}

namespace render {

void check_importance(const ImportanceOptions& options) {
  const auto require = [](bool right, const char* what) {
    if (!right) throw Error(ErrorKind::bad_argument, what);
  };
  require(options.alpha >= 0 && options.alpha <= 1, "--complexity: ALPHA is not in 0..1");
  require(options.limit > 0 && std::isfinite(options.limit), "--complexity: LIMIT is not a positive number");
  require(std::isfinite(options.focus_x) && std::isfinite(options.focus_y), "--focus: not two numbers");
  require(options.falloff > 0 && std::isfinite(options.falloff), "--falloff: not a positive number");
  require(options.noise >= 0 && options.noise <= 1, "--importance-noise: not in 0..1");
  if (std::find(options.terms.begin(), options.terms.end(), ImportanceTerm::image) == options.terms.end())
    return;
  const ImportanceImage& image = options.image;
  require(!image.bytes.empty() && image.bytes.size() == std::uint64_t{image.width} * image.height,
          "--importance image: there is no picture, or it has not a byte a pixel");
}

}  // namespace render
}  // namespace pellucid
