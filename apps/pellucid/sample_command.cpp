// Implements `pellucid sample`, which writes procedural scenes, so that nothing must be downloaded.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "choice.h"
#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {
namespace {

struct SampleOptions {
  const CLI::App* command = nullptr;  // knows which options were given
  std::string name;
  std::string output;
  double detail = 1;
  bool list = false;
};

void list_samples(Session& session, const SampleOptions& options) {
  const std::string only_lists = "--list writes no sample";
  refuse_without_effect(*options.command,
                        {needs("NAME", false, only_lists), needs("--output", false, only_lists),
                         needs("--detail", false, only_lists)});
  nlohmann::ordered_json samples = nlohmann::ordered_json::array();
  std::string text;
  for (const SampleInfo& sample : sample_list()) {
    text += fmt::format("{:<16} {}\n", sample.name, sample.description);
    samples.push_back({{"name", sample.name}, {"description", sample.description}});
  }
  session.print(text);
  const nlohmann::ordered_json json = {{"schema", 1}, {"version", library_version()}, {"samples", samples}};
  session.write_json(json.dump(2) + "\n");
}

void write_sample(Session& session, const SampleOptions& options) {
  if (options.name.empty())
    throw Error(ErrorKind::bad_argument, "no sample named (see pellucid sample --list)");
  if (options.output.empty()) throw Error(ErrorKind::bad_argument, "no output file given: -o OUT.glb");
  const std::vector<SamplePart> parts = make_sample(options.name, options.detail);
  const Model model = make_model(parts, options.name);
  const WriteReport written = write_model(model, {}, options.output);
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  for (const SamplePart& part : parts) {
    triangles += part.mesh.triangles.size();
    vertices += part.mesh.positions.size();
  }
  session.print(fmt::format("{}: {} in {} part(s), {} triangles, {}\n", options.output, options.name,
                            parts.size(), format_count(triangles), format_bytes(written.file_bytes)));
  const nlohmann::ordered_json json = {{"schema", 1},           {"version", library_version()},
                                       {"name", options.name},  {"output", options.output},
                                       {"parts", parts.size()}, {"triangles", triangles},
                                       {"vertices", vertices},  {"file_bytes", written.file_bytes}};
  session.write_json(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace

void add_sample_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<SampleOptions>();
  CLI::App* command = add_command(
      app, chosen, "sample", "Write a procedural sample scene",
      "  pellucid sample --list\n"
      "  pellucid sample goblet -o goblet.glb\n"
      "  pellucid sample torus-knot -o knot.glb --detail 4",
      1,
      [options](Session& session) {
        if (options->list) {
          list_samples(session, *options);
        } else {
          write_sample(session, *options);
        }
      },
      Reads::nothing);
  options->command = command;
  command->add_option("NAME", options->name, "Name of the sample (see --list)")->type_name("");
  command->add_option("-o,--output", options->output, "The file to write: .glb or .gltf")
      ->type_name("FILE")
      ->group("Output");
  command->add_option("--detail", options->detail, "Multiply the number of triangles by X, 0.01 to 1000")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str()
      ->group("Output");
  command->add_flag("--list", options->list, "List the samples instead")->group("Output");
}

}  // namespace pellucid::cli
