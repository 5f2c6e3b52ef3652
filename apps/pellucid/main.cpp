// The command line: parses the arguments, runs one subcommand, and turns every failure into one line and an
// exit code.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {
namespace {

constexpr int kInternal = 1;
constexpr int kUsage = 2;

constexpr const char* kExitCodes =
    "Run 'pellucid SUBCOMMAND --help' for the options of a subcommand, with examples.\n"
    "Exit codes: 0 success, 1 internal failure or a file that cannot be written, 2 wrong usage, 3 bad "
    "input,\n"
    "4 nothing to do, 5 quality target missed, 130 interrupted.";

// Lays out --help: the name of the value, then what the option does and its default, without types and
// checks. Groups come in the order in which they were added, with the common options last.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(34); }

  [[nodiscard]] std::string make_help(const CLI::App* app, std::string name,
                                      CLI::AppFormatMode mode) const override {
    return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) + groups_of(app) +
           make_subcommands(app, mode) + "\n" + make_footer(app);
  }

  [[nodiscard]] std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return {};
    // CLI11 appends the checks of a value after a colon.
    std::string name = option->get_type_name();
    name = name.substr(0, name.find(':'));
    if (name == "UINT" || name == "INT") name = "N";
    if (name == "FLOAT") name = "X";
    if (option->get_expected_max() > 1) name += "...";
    return name.empty() ? name : " " + name;
  }

  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override {
    const std::string value = option->get_default_str();
    return option->get_description() + (value.empty() ? "" : " (default " + value + ")");
  }

 private:
  [[nodiscard]] std::string groups_of(const CLI::App* app) const {
    std::vector<std::string> groups = app->get_groups();
    std::stable_partition(groups.begin(), groups.end(),
                          [](const std::string& name) { return name != kCommonGroup; });
    std::string text;
    for (const std::string& group : groups) {
      const auto options = app->get_options(
          [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
      // Hidden options have no group.
      if (!group.empty() && !options.empty()) text += make_group(group, false, options);
    }
    return text;
  }
};

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

// Prints help or the version. They are results, too, so a full disk behind stdout is a failure.
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
  CLI::App app(
      "pellucid computes draw orders for meshes: translucent meshes blend correctly without sorting at run\n"
      "time, opaque ones waste fewer fragments. It also captures all fragments of an image on the GPU.",
      "pellucid");
  app.footer(kExitCodes);
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
