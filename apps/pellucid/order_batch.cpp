// Implements order_batch.h: many models in one call.
#include "order_batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <new>
#include <set>

#include "base/platform/platform.h"

namespace pellucid::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array kGravestFirst{ErrorKind::internal,      ErrorKind::cannot_write,
                                   ErrorKind::bad_input,     ErrorKind::bad_argument,
                                   ErrorKind::nothing_to_do, ErrorKind::quality_missed};

// Returns the same text for the same file, whatever path names it.
std::string canonical(const std::string& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(path, error);
  return error ? path : found.string();
}

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ErrorKind::cannot_write, folder + ": cannot make this folder: " + error.message());
}

class Batch {
 public:
  Batch(const RunOptions& options, const std::string& folder, Session& session)
      : options_(options), jobs_(plan_batch(options, folder)), session_(session) {
    report_.inputs = jobs_.size();
    make_folder(folder);
    if (!options.checkpoint.empty()) make_folder(options.checkpoint);
  }

  void run(const std::function<BatchOutcome(const BatchJob&)>& order) {
    session_.check_json();
    for (std::size_t i = 0; i < jobs_.size() && !report_.interrupted; ++i) {
      session_.set_file(
          fmt::format("{}/{} {}", i + 1, jobs_.size(), fs::path(jobs_[i].input).filename().string()));
      run_job(jobs_[i], order);
    }
    session_.set_file("");
    // The jobs have emptied the folder, unless one of them can continue from its records.
    if (!options_.checkpoint.empty()) platform::remove_empty_folder(options_.checkpoint);
    finish();
  }

 private:
  void run_job(const BatchJob& job, const std::function<BatchOutcome(const BatchJob&)>& order) {
    if (options_.skip_existing && is_up_to_date(job)) {
      report_.skipped.emplace_back(job.input, job.output);
      session_.print(fmt::format("{}: is there: skipped\n", job.output));
      return;
    }
    try {
      stop_if_signalled();
      BatchOutcome outcome = order(job);
      session_.print(to_line(outcome.report));
      report_.results.push_back(std::move(outcome.report));
      if (!outcome.missed_quality.empty()) fail(job, ErrorKind::quality_missed, outcome.missed_quality);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) {
        report_.interrupted = true;
      } else {
        fail(job, error.kind(), error.what());
      }
    } catch (const std::bad_alloc&) {
      fail(job, ErrorKind::internal, job.input + ": " + kOutOfMemory);
    } catch (const std::exception& error) {
      fail(job, ErrorKind::internal, job.input + ": internal error: " + error.what());
    }
    session_.set_subject("");
  }

  void fail(const BatchJob& job, ErrorKind kind, std::string message) {
    // Some messages do not name the file.
    if (message.find(job.input) == std::string::npos) message = job.input + ": " + message;
    session_.complain(message);
    report_.failures.push_back({job.input, job.output, exit_code(kind), std::move(message)});
    kinds_.insert(kind);
  }

  void finish() {
    report_.seconds_total = watch_.seconds();
    report_.peak_rss_bytes = peak_rss_bytes();
    const auto missed = std::count_if(report_.failures.begin(), report_.failures.end(), [](const auto& f) {
      return f.exit_code == exit_code(ErrorKind::quality_missed);
    });
    std::string summary =
        fmt::format("{} of {} file(s) ordered, {} skipped, {} failed", report_.results.size(), jobs_.size(),
                    report_.skipped.size(), report_.failures.size() - static_cast<std::size_t>(missed));
    if (missed > 0) summary += fmt::format(", {} missed the quality asked for", missed);
    session_.print(fmt::format("{}; {} in all, peak memory {}\n", summary,
                               format_seconds(report_.seconds_total), format_bytes(report_.peak_rss_bytes)));
    session_.write_json(to_json(report_));
    // Failures are repeated at the end, because their first messages have scrolled away.
    if (jobs_.size() > 1) {
      for (const OrderFailure& failure : report_.failures) session_.complain("failed: " + failure.message);
    }
    if (report_.interrupted) {
      throw Error(ErrorKind::interrupted,
                  "interrupted: " + summary + "; the same command with --skip-existing goes on" +
                      (options_.checkpoint.empty() ? "" : " from the records in " + options_.checkpoint));
    }
    for (const ErrorKind kind : kGravestFirst) {
      if (kinds_.contains(kind)) throw Error(kind, summary);
    }
  }

  const RunOptions& options_;
  std::vector<BatchJob> jobs_;
  Session& session_;
  Stopwatch watch_;
  OrderBatchReport report_;
  std::set<ErrorKind> kinds_;
};

}  // namespace

void add_run_options(CLI::App& command, RunOptions& options) {
  const char* group = "Long runs and many files";
  command
      .add_option("MODEL", options.inputs,
                  "Model to read: glTF, GLB, PLY, OBJ, STL or OFF; several are written into OUTDIR/")
      ->type_name("");
  command
      .add_option("--model-list", options.list,
                  "Order also the models that FILE names, one per line; lines that begin with # are skipped")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--checkpoint", options.checkpoint, "Keep finished parts in DIR and continue from them")
      ->type_name("DIR")
      ->group(group);
  command
      .add_flag("--skip-existing", options.skip_existing,
                "Skip models whose output exists and is not older than the model")
      ->group(group);
}

bool is_up_to_date(const BatchJob& job) {
  std::error_code error;
  const auto made = fs::last_write_time(job.output, error);
  if (error) return false;
  const auto changed = fs::last_write_time(job.input, error);
  return !error && made >= changed;
}

std::vector<std::string> read_path_list(const std::string& file) {
  const std::vector<std::byte> bytes = read_file(file);
  std::vector<std::string> paths;
  for (std::string line : text_lines({reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.pop_back();
    const std::size_t first = line.find_first_not_of(" \t");
    if (first != std::string::npos && line[first] != '#') paths.push_back(line.substr(first));
  }
  return paths;
}

std::vector<std::string> all_inputs(const RunOptions& options) {
  std::vector<std::string> inputs = options.inputs;
  if (!options.list.empty()) {
    const std::vector<std::string> listed = read_path_list(options.list);
    inputs.insert(inputs.end(), listed.begin(), listed.end());
  }
  if (inputs.empty()) {
    throw Error(ErrorKind::bad_argument, options.list.empty() ? "no model given (see pellucid order --help)"
                                                              : options.list + ": it names no models");
  }
  return inputs;
}

bool is_into_folder(const RunOptions& options, const std::string& output) {
  if (output.ends_with('/')) return true;
  if (options.inputs.size() == 1 && options.list.empty()) return false;
  const std::string extension = fs::path(output).extension().string();
  std::error_code ignored;
  if ((extension == ".glb" || extension == ".gltf") && !fs::is_directory(output, ignored)) {
    throw Error(ErrorKind::bad_argument, "several models need a folder to be written to: -o OUTDIR/");
  }
  return true;
}

std::vector<BatchJob> plan_batch(const RunOptions& options, const std::string& folder) {
  const std::vector<std::string> inputs = all_inputs(options);
  std::map<std::string, std::string> known;  // canonical input -> input as it was given
  for (const std::string& input : inputs) known.emplace(canonical(input), input);
  std::map<std::string, std::string> taken;  // output -> its input
  std::vector<BatchJob> jobs;
  for (const std::string& input : inputs) {
    const fs::path path(input);
    const std::string name = path.stem().string() + (path.extension() == ".gltf" ? ".gltf" : ".glb");
    const std::string output = (fs::path(folder) / name).string();
    const auto [first, is_free] = taken.emplace(output, input);
    if (!is_free) {
      throw Error(ErrorKind::bad_argument,
                  fmt::format("{} and {} would both be written to {}: order them into different folders",
                              first->second, input, output));
    }
    const auto overwritten = known.find(canonical(output));
    if (overwritten != known.end()) {
      throw Error(ErrorKind::bad_argument, fmt::format("{} would be overwritten by {}: choose another folder",
                                                       overwritten->second, output));
    }
    jobs.push_back({input, output, options.checkpoint.empty() ? "" : options.checkpoint + "/" + name});
  }
  return jobs;
}

void run_batch(const RunOptions& options, const std::string& folder, Session& session,
               const std::function<BatchOutcome(const BatchJob&)>& order) {
  Batch(options, folder, session).run(order);
}

}  // namespace pellucid::cli
