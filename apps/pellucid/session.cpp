// What the subcommands share: see session.h.
#include "session.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "terminal_progress.h"

namespace pellucid::cli {
namespace {

void write_stdout(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Error(ErrorKind::cannot_write,
                std::string("standard output: cannot write: ") + std::strerror(errno));
  }
}

}  // namespace

Session::Session(CommonOptions options)
    : options_(std::move(options)), progress_(std::make_unique<TerminalProgress>(!options_.quiet)) {}

Session::~Session() = default;

void Session::set_subject(const std::string& subject) {
  static_cast<TerminalProgress&>(*progress_).set_subject(subject);
}

void Session::print(const std::string& text) const {
  static_cast<TerminalProgress&>(*progress_).clear();
  if (options_.json != "-" && !options_.quiet) write_stdout(text);
}

void Session::note(const std::string& line) const {
  static_cast<TerminalProgress&>(*progress_).clear();
  if (!options_.quiet) std::fprintf(stderr, "pellucid: note: %s\n", line.c_str());
}

void Session::detail(const std::string& line) const {
  if (!options_.verbose) return;
  static_cast<TerminalProgress&>(*progress_).clear();
  std::fprintf(stderr, "pellucid: %s\n", line.c_str());
}

void Session::write_json(const std::string& json) const {
  static_cast<TerminalProgress&>(*progress_).clear();
  if (options_.json.empty()) return;
  if (options_.json == "-") {
    write_stdout(json);
  } else {
    write_file_atomically(options_.json, json);
  }
}

CLI::App* add_command(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& description,
                      const std::string& examples, std::uint64_t default_seed, Work work) {
  CLI::App* command = app.add_subcommand(name, description);
  auto options = std::make_shared<CommonOptions>();
  options->seed = default_seed;
  command->add_option("--json", options->json, "Write statistics as JSON to FILE (\"-\": stdout, no table)")
      ->type_name("FILE")
      ->group("Common");
  command
      ->add_option("--threads", options->threads,
                   "Use at most N threads (0: all cores); never changes results")
      ->type_name("N")
      ->group("Common");
  command->add_option("--seed", options->seed, "Seed of everything random")
      ->type_name("N")
      ->capture_default_str()
      ->group("Common");
  command->add_flag("-q,--quiet", options->quiet, "Errors only")->group("Common");
  command->add_flag("-v,--verbose", options->verbose, "Tell more on stderr")->group("Common");
  command->footer("Examples:\n" + examples);
  command->callback([&chosen, options, work = std::move(work)] {
    chosen.options = *options;
    chosen.work = work;
  });
  return command;
}

}  // namespace pellucid::cli
