// What `pellucid order` was told.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "order_batch.h"
#include "pellucid/asset.h"
#include "pellucid/transparency.h"
#include "selection.h"
#include "splitting.h"

namespace pellucid::cli {

enum class FacingChoice { automatic, single, duplicated };

struct OrderCommandOptions {
  RunOptions run;
  std::string input, output;  // of the file at hand; at first the output as it was given
  std::string checkpoint;     // of the file at hand
  OrderOptions order;
  std::string views = "S2,2";
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
  std::uint32_t validate = 60;
  bool dry_run = false;
};

void add_order_options(CLI::App& command, OrderCommandOptions& options);

// Refuses what contradicts itself, Error{bad_argument}, and fills options.order and options.write from what
// was said as text.
void settle_options(OrderCommandOptions& options);

// Throws Error{bad_argument} unless it ends in .glb or .gltf, Error{cannot_write} where it cannot be written.
void check_output(const std::string& path);

}  // namespace pellucid::cli
