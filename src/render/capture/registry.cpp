// The list of capture techniques: a new one is a file beside this and a line here.
#include "buffer_techniques.h"

namespace pellucid::render {

const std::vector<TechniqueEntry>& technique_entries() {
  static const std::vector<TechniqueEntry> kEntries{
      k_buffer(),         multi_k_buffer(), stencil_routing(), uniform_buckets(), bucketed_lists(),
      adaptive_buckets(), fixed_arrays(),   linked_lists(),    s_buffer(),
  };
  return kEntries;
}

}  // namespace pellucid::render
