// Long runs and many models in one call of `pellucid order`: one output each, and a failure of one does not
// stop the rest.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {

struct RunOptions {
  std::vector<std::string> inputs;
  std::string list;        // a file that names more inputs
  std::string checkpoint;  // folder of records; empty: none
  bool skip_existing = false;
};
void add_run_options(CLI::App& command, RunOptions& options);

// All inputs, those of the list behind those of the command line. Throws Error{bad_argument} where there are
// none.
std::vector<std::string> all_inputs(const RunOptions& options);

// One path a line; empty lines and those that begin with # are left out.
std::vector<std::string> read_path_list(const std::string& file);

// One model into one file (false), or any number of them into a folder. Throws Error{bad_argument} for many
// into one file.
bool is_into_folder(const RunOptions& options, const std::string& output);

struct BatchJob {
  std::string input, output, checkpoint;
};
// The output is there and not older than the input.
bool is_up_to_date(const BatchJob& job);

// FOLDER/STEM.gltf for a .gltf, FOLDER/STEM.glb for all others, and a folder of records for each. Throws
// Error{bad_argument} where two inputs would have the same output, or an output would overwrite an input.
std::vector<BatchJob> plan_batch(const RunOptions& options, const std::string& folder);

// What becomes of one file: its report, and how far it fell short although it was written (empty: it did
// not).
struct BatchOutcome {
  OrderReport report;
  std::string missed_quality;
};

// Run the jobs one after the other; missing folders are made. A failure is told when it happens and again at
// the end; then the call throws an Error of the gravest kind: cannot write or internal, bad input, usage,
// nothing to do, quality. An interruption ends the batch; what is done stays.
void run_batch(const RunOptions& options, const std::string& folder, Session& session,
               const std::function<BatchOutcome(const BatchJob&)>& order);

}  // namespace pellucid::cli
