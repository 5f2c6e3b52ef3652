// Long runs and many models in one call of `pellucid order`. Each model has one output, and a failure of one
// does not stop the rest.
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

// Returns the inputs of the command line, then those of the list. Throws Error{bad_argument} if there are
// none.
std::vector<std::string> all_inputs(const RunOptions& options);

// Reads one path per line. Ignores empty lines and those that begin with #.
std::vector<std::string> read_path_list(const std::string& file);

// Returns whether the models are written into a folder (true), or one model into one file (false). Throws
// Error{bad_argument} for several models and one file.
bool is_into_folder(const RunOptions& options, const std::string& output);

struct BatchJob {
  std::string input, output, checkpoint;
};
// Returns whether the output exists and is not older than the input.
bool is_up_to_date(const BatchJob& job);

// Plans FOLDER/STEM.gltf for a .gltf, FOLDER/STEM.glb for all others, and a folder of records for each.
// Throws Error{bad_argument} if two inputs would have the same output, or an output would overwrite an input.
std::vector<BatchJob> plan_batch(const RunOptions& options, const std::string& folder);

// The result of one file: its report and, if it was written but missed the quality target, a message.
struct BatchOutcome {
  OrderReport report;
  std::string missed_quality;
};

// Runs the jobs one after the other and creates missing folders. A failure is printed when it happens and
// again at the end. The call then throws an Error of the gravest kind: cannot write or internal, bad input,
// usage, nothing to do, quality. An interruption ends the batch and keeps the files that are written.
void run_batch(const RunOptions& options, const std::string& folder, Session& session,
               const std::function<BatchOutcome(const BatchJob&)>& order);

}  // namespace pellucid::cli
