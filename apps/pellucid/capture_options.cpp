// Implements capture_options.h: options of the subcommands that capture fragments.
#include "capture_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "budget_options.h"
#include "choice.h"

namespace pellucid::cli {
namespace {

void add_image_options(CLI::App& command, CaptureJob& job) {
  RenderOptions& options = job.options;
  std::vector<std::pair<std::string, Effect>> effects;
  for (const NamedEffect& e : render_effects()) effects.emplace_back(e.name, e.effect);
  add_choice(command, "--effect", options.effect, effects,
             "What is made of the fragments of a pixel (default transparency)")
      ->group(kImageGroup);
  add_choice(command, "--csg", options.csg,
             {{"union", CsgOperation::union_of_all},
              {"intersection", CsgOperation::intersection},
              {"difference", CsgOperation::difference}},
             "Operation of --effect csg on the file's objects; difference: the first minus all others")
      ->group(kImageGroup);
  add_choice(command, "--surfaces", job.surfaces, {{"uniform", Surfaces::uniform}, {"file", Surfaces::file}},
             "uniform: all of one colour (default); file: its materials: colours, textures, alpha modes")
      ->group(kImageGroup);
  command.add_option("--samples,--msaa", options.samples, "Samples of a pixel: 1 or 4")
      ->check(CLI::IsMember({1, 4}))
      ->type_name("N")
      ->capture_default_str()
      ->group(kImageGroup);
  command
      .add_flag("--ignore-orders", job.ignore_orders,
                "Draw triangles as they are stored, not in the file's draw orders")
      ->group(kImageGroup);
}

void add_technique_options(CLI::App& command, CaptureJob& job) {
  RenderOptions& options = job.options;
  command
      .add_option("--k", options.k,
                  "Fragments, samples or buckets of a pixel, of techniques with a fixed number")
      ->check(CLI::Range(1, 64))
      ->type_name("N")
      ->capture_default_str()
      ->group(kTechniqueGroup);
  add_choice(command, "--sync", options.k_buffer.sync, sync_names(),
             "How k-buffers keep fragments of a pixel apart (default automatic; see pellucid techniques)")
      ->group(kTechniqueGroup);
  command
      .add_option("--heap-from", options.k_buffer.heap_from,
                  "k-plus and variable-k by interlock or spinlock: slots from which a pixel has a heap")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N")
      ->capture_default_str()
      ->group(kTechniqueGroup);
  command
      .add_flag("--cull", options.peeling.cull,
                "Techniques that peel: do not draw again what is peeled completely")
      ->group(kTechniqueGroup);
  command
      .add_flag("--plain-resolve", options.plain_resolve,
                "Sort by insertion into a local array of 128 fragments, as is common; for comparison only")
      ->group(kTechniqueGroup);
  command
      .add_option("--frames", job.frames,
                  "Number of frames to render; the time is the median of all but the first")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str()
      ->group(kTechniqueGroup);
  command.add_option("--device", job.device.device, "Vulkan device, by a part of its name")
      ->type_name("NAME")
      ->group(kTechniqueGroup);
  command.add_flag("--validation-layers", job.device.validate, "Draw under Vulkan's validation layers")
      ->group(kTechniqueGroup);
  refuse_old_option(command, "--validate", "--validation-layers");
}

// An option that only some techniques use, and the group that says which (TechniqueInfo::groups).
struct GroupOption {
  const char* option;
  OptionGroup group;
};
constexpr std::array<GroupOption, 15> kGroupOptions{{{"--k", OptionGroup::k},
                                                     {"--sync", OptionGroup::sync},
                                                     {"--heap-from", OptionGroup::critical_sections},
                                                     {"--cull", OptionGroup::culling},
                                                     {"--plain-resolve", OptionGroup::sorting},
                                                     {"--pool", OptionGroup::pool},
                                                     {"--overflow", OptionGroup::overflow},
                                                     {"--device-memory", OptionGroup::budget},
                                                     {"--allocation", OptionGroup::importance},
                                                     {"--importance", OptionGroup::importance},
                                                     {"--importance-image", OptionGroup::importance},
                                                     {"--complexity", OptionGroup::importance},
                                                     {"--focus", OptionGroup::importance},
                                                     {"--falloff", OptionGroup::importance},
                                                     {"--importance-noise", OptionGroup::importance}}};

std::string users_of(OptionGroup group) {
  std::string names;
  for (const TechniqueInfo& technique : render_techniques()) {
    if (technique.uses(group)) names.append(names.empty() ? "" : ", ").append(technique.name);
  }
  return names;
}

void refuse_options_of_other_techniques(const CLI::App& command,
                                        const std::vector<TechniqueInfo>& techniques) {
  const std::string who =
      techniques.size() == 1 ? "technique " + techniques.front().name + " does" : "the chosen techniques do";
  for (const GroupOption& option : kGroupOptions) {
    const bool used = std::any_of(techniques.begin(), techniques.end(),
                                  [&](const TechniqueInfo& t) { return t.uses(option.group); });
    if (used || command.count(option.option) == 0) continue;
    const std::string users = users_of(option.group);
    throw Error(
        ErrorKind::bad_argument,
        fmt::format("{} would have no effect: {} not use it; {}", option.option, who,
                    users.empty() ? "the techniques that do need Vulkan, which this build does not have"
                                  : "techniques that do: " + users));
  }
}

bool has_term(const RenderOptions& options, ImportanceTerm term) {
  const std::vector<ImportanceTerm>& terms = options.budget.importance.terms;
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

}  // namespace

void add_capture_options(CLI::App& command, CaptureJob& job) {
  add_image_options(command, job);
  add_technique_options(command, job);
  add_budget_options(command, job.options, job.importance_image);
}

void refuse_capture_options_without_effect(const CLI::App& command, const CaptureJob& job,
                                           const std::vector<TechniqueInfo>& techniques, bool sweeps_memory) {
  refuse_options_of_other_techniques(command, techniques);
  const RenderOptions& options = job.options;
  const auto any = [&](auto&& wanted) { return std::any_of(techniques.begin(), techniques.end(), wanted); };
  const bool has_budget = options.budget.bytes != 0 || sweeps_memory;
  const bool has_pool = options.pool.nodes != 0 || sweeps_memory;
  // With a memory budget, k is as large as fits.
  const bool uses_k = any([&](const TechniqueInfo& t) {
    return t.uses(OptionGroup::k) && (options.budget.bytes == 0 || !t.uses(OptionGroup::budget));
  });
  const bool can_overflow = any([&](const TechniqueInfo& t) {
    return t.uses(OptionGroup::overflow) && (t.uses(OptionGroup::pool) ? has_pool : has_budget);
  });
  // `auto` chooses variable-k only with a memory budget. variable-k itself always has one.
  const bool uses_importance = any([&](const TechniqueInfo& t) {
    return t.uses(OptionGroup::importance) && (t.uses(OptionGroup::maps) || has_budget);
  });
  const Sync sync = options.k_buffer.sync;
  const bool locks = sync == Sync::interlock || sync == Sync::spinlock;
  const bool draws_in_order = any([](const TechniqueInfo& t) { return t.name != cpu_technique().name; });
  const std::string needs_budget = "auto gives out slots by importance with --device-memory only";
  refuse_without_effect(
      command,
      {needs("--csg", options.effect == Effect::csg, "only --effect csg combines objects"),
       needs("--k", uses_k, "--device-memory decides how many fragments are kept"),
       needs("--overflow", can_overflow,
             "everything fits without --pool, or with --technique auto without --device-memory"),
       needs("--heap-from", locks, "only --sync interlock and --sync spinlock use heaps"),
       needs("--allocation", uses_importance, needs_budget),
       needs("--importance", uses_importance, needs_budget),
       needs("--importance-noise", uses_importance, needs_budget),
       needs("--importance-image", has_term(options, ImportanceTerm::image),
             "only --importance image reads it"),
       needs("--complexity", uses_importance, needs_budget), needs("--focus", uses_importance, needs_budget),
       needs("--falloff", uses_importance, needs_budget),
       needs("--complexity", has_term(options, ImportanceTerm::complexity),
             "only --importance complexity uses it"),
       needs("--focus", has_term(options, ImportanceTerm::periphery), "only --importance periphery uses it"),
       needs("--falloff", has_term(options, ImportanceTerm::periphery),
             "only --importance periphery uses it"),
       needs("--ignore-orders", draws_in_order,
             "technique cpu sorts all fragments, whatever the draw order")});
}

std::vector<std::pair<std::string, Sync>> sync_names() {
  std::vector<std::pair<std::string, Sync>> names{{"automatic", Sync::automatic}};
  for (const NamedSync& way : sync_ways()) names.emplace_back(way.name, way.sync);
  return names;
}

TechniqueInfo cpu_technique() {
  return {.name = "cpu",
          .title = "every fragment of every pixel on the CPU: the oracle",
          .paper = "",
          .exact = true,
          .captures = "all",
          .passes_formula = "1",
          .bytes_formula = "8 N + 8",
          .needs_atomics64 = false,
          .needs_layered = false};
}

TechniqueInfo technique_info(const std::string& name, const std::string& option, const std::string& more) {
  std::string names = cpu_technique().name;
  for (const TechniqueInfo& technique : render_techniques()) {
    if (technique.name == name) return technique;
    names.append(", ").append(technique.name);
  }
  if (name == cpu_technique().name) return cpu_technique();
  throw Error(ErrorKind::bad_argument,
              fmt::format("{}: there is no '{}'; there are {}{}{}", option, name, more, names,
                          render_techniques().empty() ? ", as pellucid was built without Vulkan" : ""));
}

Size parse_size(const std::string& text) {
  Size size;
  int used = 0;
  if (std::sscanf(text.c_str(), "%ux%u%n", &size.width, &size.height, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size() || size.width == 0 || size.height == 0 ||
      size.width > 16384 || size.height > 16384) {
    throw Error(ErrorKind::bad_argument, "--size: '" + text + "' is not WIDTHxHEIGHT of 1..16384 pixels");
  }
  return size;
}

}  // namespace pellucid::cli
