// The options of `pellucid order`. In: a command line. Out: checked options.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "order_batch.h"
#include "pellucid/asset.h"
#include "pellucid/transparency.h"
#include "selection.h"

namespace pellucid::cli {

enum class FacingChoice { automatic, single, duplicated };

struct SplitChoice {
  bool split = false;
  double limit = 0.5;  // new triangles, as a share of those of the primitive
};

struct OrderCommandOptions {
  const CLI::App* command = nullptr;  // knows which options were given
  RunOptions run;
  std::string input, output;  // of the current file; at first the output as it was given
  std::string checkpoint;     // of the current file
  bool in_batch = false;      // one of several files
  OrderOptions order;
  std::string partition = "S2,2";
  std::string distances;
  double distance = 0;
  bool perspective = false, orthographic = false;
  std::uint32_t buffers = 0;
  bool target_given = false;  // --max-error or --min-psnr
  std::vector<std::string> frontier;
  FacingChoice facing = FacingChoice::automatic;
  SelectionOptions selection;
  CleanOptions clean;
  SplitChoice split;
  std::uint32_t simplify = 0;
  WriteOptions write;
  bool no_bake_base = false;
  std::uint32_t check_views = 60;
  bool dry_run = false;
};

void add_order_options(CLI::App& command, OrderCommandOptions& options);

// Fills options.order and options.write from the text that was given. Throws Error{bad_argument} for options
// that contradict each other or have no effect.
void settle_options(OrderCommandOptions& options);

// Throws Error{bad_argument} for options that have no effect on such a model.
void refuse_for_model(const OrderCommandOptions& options, const Model& model);

// Throws Error{bad_argument} unless the path ends in .glb or .gltf, and Error{cannot_write} if it cannot be
// written.
void check_output(const std::string& path);

// Returns whether a path of --frontier is a plot, which ends in .svg; others end in .json.
bool is_plot(const std::string& path);

}  // namespace pellucid::cli
