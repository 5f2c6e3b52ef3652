// Options of the subcommands that capture fragments: see capture_options.h.
#include "capture_options.h"

#include <cstdio>

#include "budget_options.h"
#include "choice.h"

namespace pellucid::cli {

void add_capture_options(CLI::App& command, CapturePicture& picture) {
  RenderOptions& options = picture.options;
  std::vector<std::pair<std::string, Effect>> effects;
  for (const NamedEffect& e : render_effects()) effects.emplace_back(e.name, e.effect);
  add_choice(command, "--effect", options.effect, effects, "What becomes of them (default transparency)");
  add_choice(command, "--csg", options.csg,
             {{"union", CsgOperation::union_of_all},
              {"intersection", CsgOperation::intersection},
              {"difference", CsgOperation::difference}},
             "Operation of --effect csg on the file's objects; difference: the first minus all others");
  add_choice(command, "--surfaces", picture.surfaces,
             {{"uniform", Surfaces::uniform}, {"file", Surfaces::file}},
             "uniform: all of one colour (default); file: its materials: colours, textures, alpha modes");
  command
      .add_option("--k", options.k,
                  "Fragments, samples or buckets of a pixel, of techniques with a fixed number")
      ->check(CLI::Range(1, 64))
      ->type_name("N")
      ->capture_default_str();
  add_choice(command, "--sync", options.sync, sync_names(),
             "How kb and techniques with a budget keep fragments of a pixel apart (default automatic; see "
             "pellucid techniques)");
  command
      .add_option("--pool", options.pool,
                  "Nodes of techniques that store in a pool; 0: as many as are needed")
      ->type_name("N")
      ->capture_default_str();
  add_choice(
      command, "--overflow", options.overflow, {{"nearest", Overflow::nearest}, {"exact", Overflow::exact}},
      "Where --pool is too small: nearest keeps the nearest, the rest is averaged (default); exact takes "
      "more rounds");
  command
      .add_option("--frames", picture.frames, "Draw so often: the time is the median of all but the first")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--samples,--msaa", options.samples, "Samples of a pixel: 1 or 4")
      ->check(CLI::IsMember({1, 4}))
      ->type_name("N")
      ->capture_default_str();
  add_budget_options(command, options, picture.importance_image);
  command.add_flag("--ignore-orders", picture.ignore_orders,
                   "Draw triangles as they are stored, not in the sequence of the file's orders");
  command.add_flag("--cull", options.cull,
                   "Techniques that peel: do not draw again what is peeled completely");
  command.add_flag("--plain-resolve", options.plain_resolve,
                   "Sort as is common, by insertion into a local array of 128: to measure against");
  command.add_option("--device", picture.device.device, "Vulkan device, by a part of its name")
      ->type_name("NAME");
  command.add_flag("--validate", picture.device.validate, "Draw under Vulkan's validation layers");
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
