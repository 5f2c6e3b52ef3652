// The list of capture techniques: a new one is a file beside this and a line here.
#include "render/automatic.h"
#include "render/capture/blending_techniques.h"
#include "render/capture/budget_techniques.h"
#include "render/capture/buffer_techniques.h"
#include "render/capture/peeling_techniques.h"

namespace pellucid::render {

const std::vector<TechniqueEntry>& technique_entries() {
  static const std::vector<TechniqueEntry> kEntries{
      f2b(),
      f2b2(),
      f2b_2p(),
      f2b_3p(),
      f2b_ll(),
      f2b_kb(),
      f2b_fab(),
      dual(),
      dual_2p(),
      dual_ll(),
      dual_kb(),
      dual_fab(),
      k_buffer(),
      multi_k_buffer(),
      bounded(),
      stencil_routing(),
      uniform_buckets(),
      bucketed_lists(),
      adaptive_buckets(),
      fixed_arrays(),
      linked_lists(),
      s_buffer(),
      fixed_k(),
      hybrid(),
      k_plus(),
      variable_k(),
      plain_blend(),
      verified_blend(),
      ordered_k(),
      weighted_blend(),
      moment_blend(),
      multi_layer_blend(),
      stochastic_blend(),
      automatic(),
  };
  return kEntries;
}

}  // namespace pellucid::render
