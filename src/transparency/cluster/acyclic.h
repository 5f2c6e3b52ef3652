// Clustering as in the paper: view cells share an order only if the union of their edges is acyclic (section
// 3).
#pragma once

#include "pellucid/transparency.h"
#include "transparency/cluster/budget.h"
#include "transparency/order_problem.h"
#include "transparency/run_records.h"

namespace pellucid {

// Greedy merging of neighbouring clusters by priority, then relaxation. Cells whose own edges are cyclic
// first lose the edges that the best order found violates (counted in `statistics`). The result's orders
// violate no kept edge. What it has after merging, and after every round of relaxation, goes to `records`.
Clustering cluster_acyclically(const OrderProblem& problem, const OrderOptions& options,
                               OrderStatistics& statistics, const RunRecords& records = {});

}  // namespace pellucid
