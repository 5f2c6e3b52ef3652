// What the subcommands share: common options, results on stdout, notes and progress on stderr, interruption,
// and exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "pellucid/asset.h"
#include "pellucid/base.h"

namespace pellucid::cli {

class TerminalProgress;

struct CommonOptions {
  std::string json;  // file for the machine-readable statistics; "-": stdout, instead of the table
  unsigned threads = 0;
  std::uint64_t seed = 1;
  bool quiet = false;
  bool verbose = false;
  bool strict = false;  // refuse files that are understood only in part
};

// One run of one subcommand.
class Session {
 public:
  explicit Session(CommonOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const CommonOptions& options() const { return options_; }
  // Returns the progress, never null. It shows a line if stderr is a terminal, and knows when the user
  // pressed Ctrl-C.
  [[nodiscard]] Progress* progress() const;
  // Puts "2/5 name: " before the stage in progress reports from now on; an empty text removes it.
  void set_subject(const std::string& subject);
  // Does the same for the file, if there are several, before the subject.
  void set_file(const std::string& file);

  // Prints results to stdout, unless the JSON goes there.
  void print(const std::string& text) const;
  // Prints one line for the user to stderr, except with --quiet.
  void note(const std::string& line) const;
  // Prints an error as one line of stderr, also with --quiet.
  void complain(const std::string& message) const;
  // Prints one line to stderr, only with --verbose.
  void detail(const std::string& line) const;
  // Returns true the first time that it is called with this path.
  [[nodiscard]] bool is_first_mention(const std::string& path) const;
  // Throws as check_writable() does if the file of --json cannot be written.
  void check_json() const;
  // Writes the JSON to the place that --json names, if it was given.
  void write_json(const std::string& json) const;

 private:
  CommonOptions options_;
  std::unique_ptr<TerminalProgress> progress_;
  mutable std::set<std::string> mentioned_;
};

// Throws Error{cannot_write} if the folder does not exist, the path is a folder, or writing is not permitted.
// Called before the work, which may take minutes.
void check_writable(const std::string& path);

// Makes Ctrl-C and SIGTERM set the flag that stop_requested() reads. A second one ends the process at once.
void install_stop_signals();
// Throws Error{interrupted} if the flag is set.
void stop_if_signalled();

// Prints "pellucid: message" on one line of stderr.
void complain(const std::string& message);

// Returns the exit code of a failure: 1 internal, 2 usage, 3 bad input, 4 nothing to do, 5 quality target
// missed, 130 interrupted.
int exit_code(ErrorKind kind);

// The message if memory is exhausted.
extern const char* const kOutOfMemory;

// A subcommand's work, run after parsing. What it throws becomes a message and an exit code.
using Work = std::function<void(Session&)>;

// Receives the work of the subcommand that the user chose.
struct Chosen {
  CommonOptions options;
  Work work;
};

// The last group of every --help.
constexpr const char* kCommonGroup = "Common";

// What a subcommand begins with. Commands that read models have the option --strict.
enum class Reads { models, nothing };
// Adds the subcommand `name` with the common options. `examples` are command lines, shown below the help.
CLI::App* add_command(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& description,
                      const std::string& examples, std::uint64_t default_seed, Work work,
                      Reads reads = Reads::models);

// Says which extensions a file requires that are not understood, or refuses them as open_model() does.
void check_extensions(const Model& model, const Session& session);

// Reads a model, and says once what of the file is left out or not understood. With --strict, throws
// Error{bad_input} for a file that requires an extension which is not understood.
Model open_model(const std::string& path, const Session& session);

void add_order_command(CLI::App& app, Chosen& chosen);
void add_overdraw_command(CLI::App& app, Chosen& chosen);
void add_measure_command(CLI::App& app, Chosen& chosen);
void add_inspect_command(CLI::App& app, Chosen& chosen);
void add_render_command(CLI::App& app, Chosen& chosen);
void add_compare_command(CLI::App& app, Chosen& chosen);
void add_sample_command(CLI::App& app, Chosen& chosen);
void add_techniques_command(CLI::App& app, Chosen& chosen);

}  // namespace pellucid::cli
