// pellucid/memory_budget.h - module `render`: what capture techniques with a memory budget do with it.
//
// `fixed-k`, `hybrid`, `k-plus` and `variable-k` keep the nearest fragments of every pixel in
// BudgetOptions::bytes bytes, all their buffers included, and fold what found no place into one translucent
// layer behind them, the tail. A slot is 8 bytes: a fragment, or a tail (of `hybrid` two). Paper: Vasilakis,
// Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps", Eurographics 2017.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pellucid {

// How variable-k gives out M slots to pixels of importance I and N fragments.
enum class Allocation {
  // min(N, 1 + ceil(l I)), with the level l at which all M slots are used; what is left over goes to pixels
  // one by
  // one.
  water,
  // floor(I / sum of I * M), equation 1 of the paper, where M is what a tail for every pixel leaves. It may
  // be
  // more than N, and 0.
  printed
};

// Terms of importance. The importance of a pixel is the product of the chosen ones.
enum class ImportanceTerm : std::uint32_t {
  opacity = 1,  // by the number of fragments that hide what is behind, from the sum of their optical depths
  complexity = 2,  // equation 3
  periphery = 4,   // equation 4
  fresnel = 8,     // equation 5, of the nearest fragment of this frame
  image = 16,      // ImportanceOptions::image
  // What the last frame of this size left to the tail; without one, a frame is drawn for it first.
  residue = 32
};
struct NamedImportanceTerm {
  ImportanceTerm term;
  std::string name, description;
};
std::span<const NamedImportanceTerm> importance_terms();

struct ImportanceImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // row by row from the upper left; 255: 1
};

struct ImportanceOptions {
  std::vector<ImportanceTerm> terms{ImportanceTerm::complexity};  // none: all pixels alike
  // Of `complexity`: importance of few fragments, and the number of fragments at which it is 1. The paper has
  // 0.25 to 0.5 and 20 to 30; docs/k-buffers.md says why 0.9 is better with a tail.
  double alpha = 0.9, limit = 25;
  double focus_x = 0.5, focus_y = 0.5;  // of `periphery`: point of interest, 0..1 from the upper left
  double falloff = 3;                   // of `periphery`
  double noise =
      0.003;  // width of the centred noise that is added; 0.1 in the paper. It spreads what is left over
  ImportanceImage image;
};

// One value for each pixel, or, pixel by pixel, for each sample. Where not every pixel has a place of its
// own, k is 0.
struct BudgetMaps {
  std::vector<float> importance;
  std::vector<std::uint32_t> k;     // fragments that have a slot
  std::vector<std::uint32_t> lost;  // fragments in the tail
};

}  // namespace pellucid
