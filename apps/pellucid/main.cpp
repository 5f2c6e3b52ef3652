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

int fail(int code, const std::string& message) {
  complain(message);
  return code;
}

void add_commands(CLI::App& app, Chosen& chosen) {
  add_order_command(app, chosen);
  add_overdraw_command(app, chosen);
  add_measure_command(app, chosen);
  add_inspect_command(app, chosen);
  add_render_command(app, chosen);
  add_compare_command(app, chosen);
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
    session.complain(error.what());
    return exit_code(error.kind());
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
    return pellucid::cli::fail(pellucid::cli::kInternal, pellucid::cli::kOutOfMemory);
  } catch (const std::exception& error) {
    return pellucid::cli::fail(pellucid::cli::kInternal, std::string("internal error: ") + error.what());
  }
}
