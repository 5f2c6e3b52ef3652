// Implements budget_options.h: options of techniques with a pool or a memory budget.
#include "budget_options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>

#include "capture_options.h"
#include "choice.h"
#include "pellucid/asset.h"
#include "pellucid/compare_report.h"
#include "pellucid/material.h"
#include "pellucid/metric.h"

namespace pellucid::cli {
namespace {

std::vector<ImportanceTerm> parse_terms(const std::string& list) {
  std::vector<ImportanceTerm> terms;
  std::istringstream stream(list);
  for (std::string name; std::getline(stream, name, ',');) {
    std::string known;
    bool found = name == "none";
    for (const NamedImportanceTerm& term : importance_terms()) {
      known.append(", ").append(term.name);
      if (name != term.name) continue;
      terms.push_back(term.term);
      found = true;
    }
    if (!found) {
      throw Error(ErrorKind::bad_argument,
                  fmt::format("--importance: '{}' is not one of none{}", name, known));
    }
  }
  return terms;
}

void parse_complexity(const std::string& text, ImportanceOptions& options) {
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf%n", &options.alpha, &options.limit, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size() || !(options.alpha >= 0 && options.alpha <= 1) ||
      !(options.limit >= 1 && options.limit <= 1e6)) {
    throw Error(ErrorKind::bad_argument,
                "--complexity: '" + text + "' is not ALPHA,LIMIT of 0..1 and 1 or more");
  }
}

void parse_focus(const std::string& text, ImportanceOptions& options) {
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf%n", &options.focus_x, &options.focus_y, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size() || !std::isfinite(options.focus_x) ||
      !std::isfinite(options.focus_y)) {
    throw Error(ErrorKind::bad_argument, "--focus: '" + text + "' is not X,Y in 0..1 from the upper left");
  }
}

// Refuses NaN, which CLI::Range accepts.
std::string is_a_number(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr)) ? "'" + text + "' is not a number" : "";
}

}  // namespace

// Uses luma instead of luminance, because what is twice as bright in linear light is not twice as important.
ImportanceImage read_importance(const std::string& path) {
  if (path.empty()) return {};
  const RgbaImage picture = read_image(path);
  ImportanceImage image{picture.width, picture.height, {}};
  for (std::size_t i = 0; i + 3 < picture.rgba.size(); i += 4) {
    const double value =
        0.2126 * picture.rgba[i] + 0.7152 * picture.rgba[i + 1] + 0.0722 * picture.rgba[i + 2];
    image.bytes.push_back(static_cast<std::uint8_t>(std::lround(value)));
  }
  return image;
}

void add_budget_options(CLI::App& command, RenderOptions& options, std::string& image) {
  ImportanceOptions& importance = options.budget.importance;
  // Errors of `parse` are reported in the same way as those of CLI11.
  const auto add = [&](const std::string& name, const std::string& type, const std::string& description,
                       std::function<void(const std::string&)> parse) {
    command
        .add_option_function<std::string>(
            name,
            [name, parse = std::move(parse)](const std::string& text) {
              try {
                parse(text);
              } catch (const Error& error) {
                throw CLI::ValidationError(error.what());
              }
            },
            description)
        ->type_name(type)
        ->group(kBudgetGroup);
  };
  command
      .add_option("--pool", options.pool.nodes,
                  "Nodes of techniques that store in a pool; 0: as many as are needed")
      ->type_name("N")
      ->capture_default_str()
      ->group(kBudgetGroup);
  add("--device-memory", "BYTES",
      "Memory budget of techniques that have one: 35MB, 20MiB (default: fixed-k, k-plus and variable-k 32 "
      "bytes "
      "a pixel, bounded 64, hybrid and multikb what --k needs, auto no limit)",
      [&](const std::string& text) { options.budget.bytes = parse_bytes("--device-memory", text); });
  refuse_old_option(command, "--memory", "--device-memory");
  add_choice(command, "--overflow", options.pool.overflow,
             {{"nearest", Overflow::nearest}, {"exact", Overflow::exact}},
             "Where pool or memory is too small: nearest keeps the nearest, averages the rest (default); "
             "exact takes "
             "more rounds")
      ->group(kBudgetGroup);
  add_choice(command, "--allocation", options.budget.allocation,
             {{"water", Allocation::water}, {"printed", Allocation::printed}},
             "variable-k: give out all of it (default), or as printed in the paper")
      ->group(kBudgetGroup);
  add("--importance", "LIST",
      "variable-k: product of opacity, complexity, periphery, fresnel, image, residue: names with commas, or "
      "none (default complexity)",
      [&](const std::string& list) { importance.terms = parse_terms(list); });
  command
      .add_option("--importance-image", image,
                  "PNG or JPEG for --importance image, stretched over the image: white is important")
      ->type_name("FILE")
      ->group(kBudgetGroup);
  add("--complexity", "ALPHA,LIMIT",
      "Of --importance complexity: importance of few fragments, number of them at which it is 1 (default "
      "0.9,25)",
      [&](const std::string& text) { parse_complexity(text, importance); });
  add("--focus", "X,Y", "Point of interest of --importance periphery, from the upper left (default 0.5,0.5)",
      [&](const std::string& text) { parse_focus(text, importance); });
  command.add_option("--falloff", importance.falloff, "Exponent of --importance periphery")
      ->check(CLI::Range(0.1, 100.0))
      ->check(is_a_number)
      ->capture_default_str()
      ->group(kBudgetGroup);
  command
      .add_option("--importance-noise", importance.noise,
                  "Noise that is added to importance; 0.1 in the paper")
      ->check(CLI::Range(0.0, 1.0))
      ->check(is_a_number)
      ->capture_default_str()
      ->group(kBudgetGroup);
}

std::uint64_t parse_bytes(const std::string& option, const std::string& text) {
  struct Unit {
    const char* name;
    double bytes;
  };
  constexpr std::array<Unit, 8> kUnits{{{"", 1},
                                        {"B", 1},
                                        {"KB", 1e3},
                                        {"MB", 1e6},
                                        {"GB", 1e9},
                                        {"KiB", 1024},
                                        {"MiB", 1048576},
                                        {"GiB", 1073741824}}};
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  for (const Unit& unit : kUnits) {
    const double bytes = number * unit.bytes;
    if (end != text.c_str() && std::string(end) == unit.name && bytes >= 1 && bytes < 1e15)
      return static_cast<std::uint64_t>(bytes);
  }
  throw Error(ErrorKind::bad_argument,
              option + ": '" + text + "' is not a number of bytes, as 35MB or 20MiB");
}

void write_maps(const RenderResult& result, std::uint32_t samples, const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error(ErrorKind::cannot_write, folder + ": " + failed.message());
  for (const NamedMap& map : budget_heat_maps(result, samples))
    write_png(map.image, (std::filesystem::path(folder) / (map.name + ".png")).string());
}

}  // namespace pellucid::cli
