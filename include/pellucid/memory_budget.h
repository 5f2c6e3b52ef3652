// pellucid/memory_budget.h - module `render`: options and results of capture techniques with a memory budget.
//
// In: how the budget is given out to pixels. Out: maps of importance, slots and lost fragments. `fixed-k`,
// `hybrid`, `k-plus` and `variable-k` keep the nearest fragments of every pixel within BudgetOptions::bytes,
// which includes all their buffers. Fragments that find no place are folded into one translucent layer behind
// the others, the tail. A slot has 8 bytes and holds a fragment or a tail; a tail of `hybrid` takes two
// slots. Based on: Vasilakis, Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps",
// Eurographics 2017.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pellucid {

// How variable-k gives out M slots to pixels with the importance I and N fragments.
enum class Allocation {
  // min(N, 1 + ceil(l I)), with the level l at which all M slots are used. Slots that are left over go to
  // pixels, one each.
  water,
  // floor(I / sum of I * M), equation 1 of the paper, where M is what remains when every pixel has a tail.
  // The result may be more than N, and it may be 0.
  printed
};

// Terms of importance. The importance of a pixel is the product of the chosen ones.
enum class ImportanceTerm : std::uint32_t {
  // By the number of fragments that it takes to hide what lies behind, from the sum of optical depths.
  opacity = 1,
  complexity = 2,  // equation 3
  periphery = 4,   // equation 4
  fresnel = 8,     // equation 5, for the nearest fragment of this frame
  image = 16,      // ImportanceOptions::image
  // By what the last frame of this size left to the tail. If there is none, one frame is drawn for it first.
  residue = 32
};
struct NamedImportanceTerm {
  ImportanceTerm term;
  std::string name, description;
};
std::span<const NamedImportanceTerm> importance_terms();

struct ImportanceImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // row by row from the upper left; 255 means 1
};

struct ImportanceOptions {
  std::vector<ImportanceTerm> terms{ImportanceTerm::complexity};  // none: all pixels are equally important
  // For `complexity`: the importance of few fragments, and the number of fragments at which it is 1. The
  // paper uses 0.25 to 0.5 and 20 to 30. docs/k-buffers.md says why 0.9 is better with a tail.
  double alpha = 0.9, limit = 25;
  double focus_x = 0.5, focus_y = 0.5;  // for `periphery`: point of interest, 0..1 from the upper left
  double falloff = 3;                   // for `periphery`: exponent
  // Width of the centred noise that is added, which spreads the slots that are left over. The paper uses 0.1.
  double noise = 0.003;
  ImportanceImage image;
};

// One value per pixel or, with several samples, per sample. k is 0 if the pixels have no places of their own.
struct BudgetMaps {
  std::vector<float> importance;
  std::vector<std::uint32_t> k;     // fragments with a slot
  std::vector<std::uint32_t> lost;  // fragments in the tail
};

}  // namespace pellucid
