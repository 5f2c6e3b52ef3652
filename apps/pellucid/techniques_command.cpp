// pellucid techniques: every way of drawing that `render` knows.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {
namespace {

void list_techniques(Session& session) {
  session.print(fmt::format("{:<8} {:<6} {}\n{:<8} {:<6} {}\n", "name", "exact", "what", "cpu", "yes",
                            "every fragment of every pixel on the CPU, in depth order: the oracle"));
  const nlohmann::ordered_json json = {{"schema", 1},
                                       {"version", library_version()},
                                       {"device", "cpu"},
                                       {"techniques",
                                        {{{"name", "cpu"},
                                          {"paper", nullptr},
                                          {"exact", true},
                                          {"available", true},
                                          {"missing", nlohmann::ordered_json::array()},
                                          {"passes_formula", "1"},
                                          {"bytes_formula", "8 * fragments + 8 * pixels"},
                                          {"msaa", {1}}}}}};
  session.write_json(json.dump(2) + "\n");
}

}  // namespace

void add_techniques_command(CLI::App& app, Chosen& chosen) {
  add_command(app, chosen, "techniques", "Every technique that render knows",
              "  pellucid techniques\n"
              "  pellucid techniques --json -",
              1, list_techniques);
}

}  // namespace pellucid::cli
