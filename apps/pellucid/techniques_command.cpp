// Implements `pellucid techniques`, which lists every capture technique of `render`, and what this machine
// lacks for it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "capture_options.h"
#include "pellucid/render.h"
#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {
namespace {

// Those that a technique has, the preferred first.
nlohmann::ordered_json ways_of(const TechniqueInfo& t) {
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  const auto ways = sync_ways();
  for (const Sync sync : t.syncs) {
    names.push_back(
        std::find_if(ways.begin(), ways.end(), [&](const NamedSync& way) { return way.sync == sync; })->name);
  }
  return names;
}

nlohmann::ordered_json to_json(const TechniqueInfo& t, const std::string& missing) {
  nlohmann::ordered_json lacks = nlohmann::ordered_json::array();
  if (!missing.empty()) lacks.push_back(missing);
  return {{"name", t.name},
          {"title", t.title},
          {"paper", t.paper.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(t.paper)},
          {"exact", t.exact},
          {"captures", t.captures},
          {"available", missing.empty()},
          {"missing", lacks},
          {"passes_formula", t.passes_formula},
          {"bytes_formula", t.bytes_formula},
          {"can_cull", t.uses(OptionGroup::culling)},
          {"blends_only", t.blends_only},
          {"budgeted", t.uses(OptionGroup::budget)},
          {"keeps_tail", t.keeps_tail},
          {"sync", ways_of(t)},
          {"msaa", {1, 4}}};
}

// Ways of --sync that the device has.
std::vector<std::string> ways_to_synchronise(const DeviceInfo& device) {
  std::vector<std::string> names;
  for (const NamedSync& way : sync_ways())
    if (missing_for(way.sync, device).empty()) names.push_back(way.name);
  return names;
}

// Empty where there is none; why, is a note.
std::optional<DeviceInfo> find_device(const DeviceOptions& options, const Session& session) {
  try {
    return Renderer(options).info();
  } catch (const Error& error) {
    if (!options.device.empty()) throw;
    session.note(error.what());
    return std::nullopt;
  }
}

void list_techniques(const DeviceOptions& options, Session& session) {
  const std::optional<DeviceInfo> device = find_device(options, session);
  std::string text = device ? fmt::format("on {} ({}), which synchronises by {}\n", device->name,
                                          device->driver, fmt::join(ways_to_synchronise(*device), ", "))
                            : "";
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const auto add = [&](const TechniqueInfo& t, const std::string& missing) {
    text += fmt::format("{:<11} {:<5} {:<26} {:<24} {}{}\n", t.name, t.exact ? "yes" : "no", t.passes_formula,
                        t.bytes_formula, t.title, missing.empty() ? "" : " (needs " + missing + ")");
    list.push_back(to_json(t, missing));
  };
  text += fmt::format("{:<11} {:<5} {:<26} {:<24} {}\n", "name", "exact", "geometry passes", "bytes a pixel",
                      "what");
  add(cpu_technique(), "");
  for (const TechniqueInfo& t : render_techniques())
    add(t, device ? missing_for(t, *device) : "a Vulkan device");
  text +=
      "N fragments of the pixel, D depth layers, C fragments of a layer, K from --k; exact: all of them, "
      "coplanar ones too\n";
  session.print(text);
  const nlohmann::ordered_json json = {
      {"schema", 1},
      {"version", library_version()},
      {"device", device ? device->name : "cpu"},
      {"sync", device ? ways_to_synchronise(*device) : std::vector<std::string>{}},
      {"techniques", list}};
  session.write_json(json.dump(2) + "\n");
}

}  // namespace

void add_techniques_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<DeviceOptions>();
  CLI::App* command = add_command(
      app, chosen, "techniques", "List every technique that render knows",
      "  pellucid techniques\n"
      "  pellucid techniques --json -",
      1, [options](Session& session) { list_techniques(*options, session); }, Reads::nothing);
  command->add_option("--device", options->device, "Vulkan device, by a part of its name")
      ->type_name("NAME")
      ->group(kTechniqueGroup);
}

}  // namespace pellucid::cli
