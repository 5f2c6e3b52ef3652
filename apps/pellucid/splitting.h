// --split: primitives without faces that have no right order.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {

struct SplitChoice {
  bool split = false;
  double limit = 0.5;  // new triangles, as a share of the primitive's
};
void add_split_options(CLI::App& command, SplitChoice& choice);

// Replaces the primitive's mesh by its pieces where there is something to cut. Empty, with a note, where the
// triangles of the primitive may not change. `distances` and `facing` are those of the orders.
std::optional<SplitReport> split_primitive(Model& model, std::uint32_t index, const SplitChoice& choice,
                                           const CleanOptions& cleaning, const OrderOptions& order,
                                           Session& session);

}  // namespace pellucid::cli
