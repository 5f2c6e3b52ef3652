// Internal to the module `asset`: from index triples back to the nodes (facings of triangles) that they draw.
#pragma once

#include <optional>
#include <vector>

#include "pellucid/sequencing.h"

namespace pellucid {

// Finds triples by their cyclic order: (a b c), (b c a) and (c a b) are the same facing. Building is O(T log
// T), a look-up O(log T) at worst.
class FacingTable {
 public:
  // Facing::single: the stored facings only.
  FacingTable(const Mesh& mesh, Facing facing);

  // Forget what was taken: the next order begins.
  void start_order();
  // The next node that draws `corners` and was not taken in this order yet; empty when there is none (left).
  // Nodes with the same triple (exact duplicates, twins of a coincident pair) come in the order of their
  // triangles, stored facings before flipped ones.
  std::optional<NodeId> take(const Triangle& corners);

 private:
  struct Entry {
    std::uint32_t second, third;  // after the smallest rotation
    NodeId node;
  };
  std::vector<std::size_t> offsets_;  // first corner -> its entries; vertices + 1
  std::vector<Entry> entries_;        // sorted by (second, third, flipped, triangle) within a first corner
  std::vector<std::uint32_t> taken_;  // at the first entry of equal triples: how many were taken
  std::vector<std::size_t> touched_;  // where taken_ is not zero
};

}  // namespace pellucid
