// The fewest orders that meet an error, or the least error for a number of orders.
//
// Multi-resolution: which views can share an order depends on the shape, hardly on its tessellation. So the
// clustering is searched on a mesh of about a thousand triangles, from several starts, and carried to the
// full mesh (upsample.h), where a few rounds finish it.
#pragma once

#include <cstdint>
#include <vector>

#include "transparency/cluster/budget.h"
#include "transparency/error_target.h"
#include "transparency/order_problem.h"
#include "transparency/run_records.h"

namespace pellucid {

// Triangles of the mesh that the search runs on.
constexpr std::uint32_t kCoarseTriangles = 1000;

struct BudgetOptions {
  ErrorTarget target;  // on held-out viewpoints
  std::uint32_t min_buffers = 1, max_buffers = 16;
  bool front_only = false;
  ValidRange range{2, 5};    // of the held-out viewpoints
  double picture_alpha = 0;  // measure the PSNR of pictures with faces of this opacity, too; 0: no
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
  RunRecords records{};  // of every number of buffers that was tried
};

struct BudgetResult {
  Clustering clustering;  // on the full mesh
  OrderError measured;    // on the held-out viewpoints
  double error = 0;       // the same by the target's measure
};

template <class Archive, RecordOf<OrderError> T>
void fields(Archive& archive, T& error) {
  archive(error.ipr, error.psnr, error.repaired);
}
template <class Archive, RecordOf<BudgetResult> T>
void fields(Archive& archive, T& result) {
  archive(result.clustering, result.measured, result.error);
}

// `coarse` is a simpler mesh, or fewer cells, or both; or `fine` itself, where there is nothing to leave out.
BudgetResult search_budget(const OrderProblem& coarse, const OrderProblem& fine,
                           const BudgetOptions& options);

// One result for every number of buffers from options.min_buffers to options.max_buffers: for each what
// search_budget() finds if it may choose no other.
std::vector<BudgetResult> solve_all_budgets(const OrderProblem& coarse, const OrderProblem& fine,
                                            const BudgetOptions& options);

// Ranks of the nodes of `fine` from those of `coarse`, for the views of `cells`.
std::vector<std::uint32_t> carry_ranks(const OrderProblem& coarse, const OrderProblem& fine,
                                       std::span<const NodeId> coarse_nodes,
                                       std::span<const std::uint32_t> coarse_ranks,
                                       std::span<const std::uint32_t> cells);

}  // namespace pellucid
