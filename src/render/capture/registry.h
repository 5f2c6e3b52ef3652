// registry.h - lists every capture technique, one per line, in the order in which they are shown: first those
// of Table 1 of the paper, then those that keep a tail, those that blend, and `auto`. docs/rendering.md says
// how to add one.
#pragma once

#include <memory>

#include "render/capture/technique.h"

// Each line has the name of a function that returns the TechniqueEntry, and the file that defines it.
#define PELLUCID_TECHNIQUES(X)                              \
  X(f2b)               /* peeling/front_to_back.cpp */      \
  X(f2b2)              /* peeling/front_to_back.cpp */      \
  X(f2b_2p)            /* peeling/dual_peeling.cpp */       \
  X(f2b_3p)            /* peeling/front_to_back.cpp */      \
  X(f2b_ll)            /* peeling/front_to_back.cpp */      \
  X(f2b_kb)            /* peeling/front_to_back.cpp */      \
  X(f2b_fab)           /* peeling/front_to_back.cpp */      \
  X(dual)              /* peeling/dual_peeling.cpp */       \
  X(dual_2p)           /* peeling/dual_peeling.cpp */       \
  X(dual_ll)           /* peeling/dual_peeling.cpp */       \
  X(dual_kb)           /* peeling/dual_peeling.cpp */       \
  X(dual_fab)          /* peeling/dual_peeling.cpp */       \
  X(k_buffer)          /* k_buffers/nearest_k.cpp */        \
  X(multi_k_buffer)    /* buffers/nearest_rounds.cpp */     \
  X(bounded)           /* buffers/nearest_rounds.cpp */     \
  X(stencil_routing)   /* buffers/stencil_routing.cpp */    \
  X(uniform_buckets)   /* buffers/bucket_pairs.cpp */       \
  X(bucketed_lists)    /* buffers/linked_lists.cpp */       \
  X(adaptive_buckets)  /* buffers/bucket_pairs.cpp */       \
  X(fixed_arrays)      /* buffers/fixed_arrays.cpp */       \
  X(linked_lists)      /* buffers/linked_lists.cpp */       \
  X(s_buffer)          /* buffers/s_buffer.cpp */           \
  X(fixed_k)           /* k_buffers/fixed_k.cpp */          \
  X(hybrid)            /* k_buffers/fixed_k.cpp */          \
  X(k_plus)            /* k_buffers/mapped_k.cpp */         \
  X(variable_k)        /* k_buffers/mapped_k.cpp */         \
  X(plain_blend)       /* blending/plain_blend.cpp */       \
  X(verified_blend)    /* blending/verified_blend.cpp */    \
  X(ordered_k)         /* blending/ordered_k.cpp */         \
  X(weighted_blend)    /* blending/summed_blends.cpp */     \
  X(moment_blend)      /* blending/summed_blends.cpp */     \
  X(multi_layer_blend) /* blending/multi_layer_blend.cpp */ \
  X(stochastic_blend)  /* blending/summed_blends.cpp */     \
  X(automatic)         /* automatic.cpp */

namespace pellucid::render {

#define PELLUCID_DECLARE(technique) TechniqueEntry technique();
PELLUCID_TECHNIQUES(PELLUCID_DECLARE)
#undef PELLUCID_DECLARE

// Returns the technique that replaces one whose pool has too few nodes for the fragments
// (buffers/nearest_rounds.cpp). It is not in the list and needs 64-bit atomics.
std::unique_ptr<Technique> nearest_rounds_in_pool(Overflow overflow);

}  // namespace pellucid::render
