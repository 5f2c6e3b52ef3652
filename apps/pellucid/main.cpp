// pellucid - the command line: parse, run one subcommand, turn every failure into one line and an exit code.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "help.h"
#include "pellucid/report.h"
#include "session.h"
#include "terminal_progress.h"

namespace pellucid::cli {
namespace {

constexpr int kInternal = 1;
constexpr int kUsage = 2;

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_argument:
      return kUsage;
    case ErrorKind::bad_input:
      return 3;
    case ErrorKind::nothing_to_do:
      return 4;
    case ErrorKind::quality_missed:
      return 5;
    case ErrorKind::interrupted:
      return 130;
    case ErrorKind::cannot_write:
    case ErrorKind::internal:
      break;
  }
  return kInternal;
}

int fail(int code, const std::string& message) {
  // One line, whatever a file name holds.
  std::string line = message;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fprintf(stderr, "pellucid: %s\n", line.c_str());
  return code;
}

void add_commands(CLI::App& app, Chosen& chosen) {
  add_order_command(app, chosen);
  add_measure_command(app, chosen);
  add_inspect_command(app, chosen);
  add_render_command(app, chosen);
  add_sample_command(app, chosen);
  add_techniques_command(app, chosen);
}

// Help and version are results too: a full disk behind stdout is a failure.
int print_result(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
    return fail(kInternal, std::string("standard output: cannot write: ") + std::strerror(errno));
  }
  return 0;
}

int run_chosen(const Chosen& chosen) {
  install_stop_signals();
  Session session(chosen.options);
  const ThreadLimit threads(chosen.options.threads);
  try {
    chosen.work(session);
    return 0;
  } catch (const Error& error) {
    session.set_subject("");
    static_cast<TerminalProgress*>(session.progress())->clear();
    return fail(exit_code(error.kind()), error.what());
  }
}

int run(int argc, char** argv) {
  CLI::App app("pellucid - visibility ordering: index buffers that draw a translucent mesh in depth order",
               "pellucid");
  app.set_version_flag("--version", std::string(library_version()));
  app.require_subcommand(0, 1);
  app.formatter(std::make_shared<HelpFormatter>());
  Chosen chosen;
  add_commands(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const auto parsed = app.get_subcommands();
    return print_result(parsed.empty() ? app.help() : parsed.front()->help("pellucid"));
  } catch (const CLI::CallForVersion&) {
    return print_result(std::string(library_version()) + "\n");
  } catch (const CLI::ParseError& error) {
    const auto parsed = app.get_subcommands();
    const std::string help =
        parsed.empty() ? "pellucid --help" : "pellucid " + parsed.front()->get_name() + " --help";
    return fail(kUsage, std::string(error.what()) + " (see " + help + ")");
  }
  if (!chosen.work) return fail(kUsage, "no command given (see pellucid --help)");
  return run_chosen(chosen);
}

}  // namespace
}  // namespace pellucid::cli

int main(int argc, char** argv) {
  try {
    return pellucid::cli::run(argc, argv);
  } catch (const std::bad_alloc&) {
    return pellucid::cli::fail(
        pellucid::cli::kInternal,
        "out of memory: try a smaller mesh (--simplify), fewer view cells (--views S1,2) or a "
        "smaller picture (--size)");
  } catch (const std::exception& error) {
    return pellucid::cli::fail(pellucid::cli::kInternal, std::string("internal error: ") + error.what());
  }
}
