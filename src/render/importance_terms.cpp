// Names of terms of importance: see pellucid/budget.h.
#include <array>

#include "pellucid/budget.h"

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

}  // namespace pellucid
