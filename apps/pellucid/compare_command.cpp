// Implements `pellucid compare`, which draws the same scenes by every capture technique and compares the
// results.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "budget_options.h"
#include "capture_options.h"
#include "choice.h"
#include "compare_output.h"
#include "comparison.h"
#include "pellucid/compare_report.h"
#include "pellucid/shading.h"
#include "session.h"

namespace pellucid::cli {
namespace {

// The sample that sweeps use if no file is named: six layers, none of them coplanar.
constexpr const char* kSweepSample = "torus-knot";

struct CompareCommand {
  const CLI::App* command = nullptr;
  std::vector<std::string> inputs;
  std::string output;
  std::string techniques = "all";
  std::string sweeps = "none";
  bool cpu_reference = false;
  std::string camera = "30,20,3";
  std::string size = "640x360";
  double alpha = 0.5;
  CaptureJob capture;
};

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream stream(list);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

std::vector<std::string> technique_names(const std::string& list) {
  std::vector<std::string> names;
  for (const std::string& name : split(list)) {
    const bool only_exact = name == "exact";
    if (name != "all" && !only_exact)
      names.push_back(technique_info(name, "--techniques", "all, exact, ").name);
    for (const TechniqueInfo& technique : render_techniques()) {
      if (name == "all" || (only_exact && technique.exact)) names.push_back(technique.name);
    }
  }
  std::vector<std::string> once;
  for (const std::string& name : names)
    if (std::find(once.begin(), once.end(), name) == once.end()) once.push_back(name);
  if (once.empty()) throw Error(ErrorKind::bad_argument, "--techniques: no technique is named");
  return once;
}

std::vector<SweepKind> sweep_kinds(const std::string& list) {
  std::vector<SweepKind> kinds;
  std::string known;
  for (const NamedSweep& sweep : compare_sweeps()) known.append(", ").append(sweep.name);
  for (const std::string& name : split(list)) {
    bool found = name == "none";
    for (const NamedSweep& sweep : compare_sweeps()) {
      if (name != "all" && name != sweep.name) continue;
      kinds.push_back(sweep.kind);
      found = true;
    }
    if (!found) {
      throw Error(ErrorKind::bad_argument,
                  fmt::format("--sweep: '{}' is not one of none, all{}", name, known));
    }
  }
  return kinds;
}

CaptureJob job_of(const CompareCommand& command) {
  CaptureJob job = command.capture;
  const Size size = parse_size(command.size);
  job.width = size.width;
  job.height = size.height;
  job.camera_text = command.camera;
  job.look.alpha = command.alpha;
  job.options.budget.importance.image = read_importance(command.capture.importance_image);
  return job;
}

ComparisonOptions options_of(const CompareCommand& command) {
  ComparisonOptions options;
  options.techniques = technique_names(command.techniques);
  options.cpu_reference = command.cpu_reference;
  options.frames = command.capture.frames;
  options.draw = command.capture.options;
  return options;
}

CompareReport new_report(const CompareCommand& command, const DeviceInfo& device) {
  CompareReport report;
  report.device = device;
  report.effect = render_effects()[static_cast<std::size_t>(command.capture.options.effect)].name;
  report.surfaces = command.capture.surfaces == Surfaces::file ? "file" : "uniform";
  report.k = command.capture.options.k;
  report.frames = command.capture.frames;
  report.memory = command.capture.options.budget.bytes;
  return report;
}

void refuse_options_without_effect(const CompareCommand& command, const std::vector<SweepKind>& sweeps) {
  std::vector<TechniqueInfo> techniques;
  for (const std::string& name : technique_names(command.techniques))
    techniques.push_back(technique_info(name, "--techniques", "all, exact, "));
  const bool sweeps_memory = std::find(sweeps.begin(), sweeps.end(), SweepKind::memory) != sweeps.end();
  refuse_capture_options_without_effect(*command.command, command.capture, techniques, sweeps_memory);
  const Effect effect = command.capture.options.effect;
  const bool shows_opacity = effect == Effect::transparency || effect == Effect::wireframe;
  const bool has_models = !command.inputs.empty();
  refuse_without_effect(*command.command,
                        {needs("--reference", has_models, "no model is given to compare techniques on"),
                         needs("--flicker", has_models, "no model is given to compare techniques on"),
                         needs("--alpha", shows_opacity, "the effect does not show opacity")});
}

void run_compare(const CompareCommand& command, Session& session) {
  const Stopwatch watch;
  const CompareOutput output(command.output);
  output.check();
  session.check_json();
  const std::vector<SweepKind> sweeps = sweep_kinds(command.sweeps);
  if (command.inputs.empty() && sweeps.empty())
    throw Error(ErrorKind::bad_argument, "no model given (see pellucid compare --help)");
  refuse_options_without_effect(command, sweeps);
  const CaptureJob job = job_of(command);
  parse_camera(command.camera);
  Renderer renderer(job.device);
  ComparisonOptions options = options_of(command);
  options.draw.budget.importance = job.options.budget.importance;
  CompareReport report = new_report(command, renderer.info());

  std::optional<DrawnScene> first;
  for (const std::string& input : command.inputs) {
    session.set_subject(input);
    begin_stage(session.progress(), "reading", 0);
    DrawnScene drawn = open_scene(open_model(input, session), job);
    for (const std::string& note : drawn.notes) session.note(note);
    stop_if_signalled();
    report.scenes.push_back(compare_techniques(renderer, drawn, options, session));
    report.scenes.back().camera = command.camera;
    if (!first) first = std::move(drawn);
  }
  if (!first && !sweeps.empty()) {
    first = open_scene(make_model(make_sample(kSweepSample, 1), kSweepSample), job);
    first->input = kSweepSample;
  }
  for (const SweepKind kind : sweeps)
    report.sweeps.push_back(sweep(renderer, *first, kind, options, session));

  for (const std::string& message : renderer.validation_messages()) session.note(message);
  stop_if_signalled();
  report.seconds_total = watch.seconds();
  report.peak_rss_bytes = peak_rss_bytes();
  output.write(report);
  session.print(to_text(report));
  session.write_json(to_json(report));
}

}  // namespace

void add_compare_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<CompareCommand>();
  constexpr std::uint32_t kFrames = 6;
  options->capture.frames = kFrames;
  CLI::App* command = add_command(
      app, chosen, "compare", "Compare capture techniques on the same scenes",
      "  pellucid compare bottles.glb -o report.html --json report.json\n"
      "  pellucid compare bottles.glb smoke.glb -o report\n"
      "  pellucid compare a.glb b.obj --techniques exact --size 1280x720 --surfaces file\n"
      "  pellucid compare stack.glb --techniques sb,f2b,f2b-2p --reference cpu\n"
      "  pellucid compare smoke.glb --techniques variable-k,mboit4 --device-memory 3MB --flicker 12\n"
      "  pellucid compare --sweep all --techniques sb,ll,f2b-2p,f2b-fab -o sweeps.html",
      1, [options](Session& session) { run_compare(*options, session); });
  CompareCommand& o = *options;
  o.command = command;
  command->add_option("MODEL", o.inputs, "glTF, GLB, PLY, OBJ, STL or OFF")->type_name("");
  command->add_option("--techniques", o.techniques, "Names with commas, all, or exact")
      ->type_name("LIST")
      ->capture_default_str()
      ->group(kComparisonGroup);
  add_choice(*command, "--reference", o.cpu_reference, {{"sb", false}, {"cpu", true}},
             "What draws the exact image that others are compared with (default sb)")
      ->group(kComparisonGroup);
  command
      ->add_option("--sweep", o.sweeps,
                   "Also vary resolution, coplanarity, depth, memory: names with commas, all, none; of the "
                   "first model, or of a sample")
      ->type_name("LIST")
      ->capture_default_str()
      ->group(kComparisonGroup);
  command
      ->add_option(
          "--flicker", o.capture.flicker,
          "Also render N frames, each half a degree further around the scene, and measure how much more "
          "the image changes than the exact one; 0: none")
      ->check(CLI::Range(0, 720))
      ->type_name("N")
      ->capture_default_str()
      ->group(kComparisonGroup);
  command->add_option("--size", o.size, "WIDTHxHEIGHT")
      ->type_name("")
      ->capture_default_str()
      ->group(kImageGroup);
  command->add_option("--alpha", o.alpha, "Opacity of a face")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(kImageGroup);
  add_capture_options(*command, o.capture);
  command
      ->add_option("--camera", o.camera, "AZIMUTH,ELEVATION,DISTANCE in degrees and bounding radii (or inf)")
      ->type_name("")
      ->capture_default_str()
      ->group(kCameraGroup);
  add_lens_options(*command, o.capture.lens);
  command
      ->add_option(
          "-o,--output", o.output,
          "The page to write (.html): tables, images, differences, plots; or a folder for report.html, "
          "report.json and images/")
      ->type_name("FILE")
      ->group(kOutputGroup);
}

}  // namespace pellucid::cli
