// Implements `pellucid render`, which draws an image of a file. Fragments are captured by a technique and
// folded by an effect, or blended in one of the draw orders of the file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "camera_options.h"
#include "capture_job.h"
#include "capture_options.h"
#include "choice.h"
#include "deep_pixels.h"
#include "pellucid/asset.h"
#include "pellucid/metric.h"
#include "pellucid/report.h"
#include "pellucid/scene.h"
#include "session.h"

namespace pellucid::cli {
namespace {

enum class OrderImage { exact, buffers, original, centroid, error };

struct RenderCommand {
  const CLI::App* command = nullptr;
  std::string input, output;
  std::string technique = "cpu";
  OrderImage order = OrderImage::exact;
  std::string order_name = "exact";
  std::string camera = "30,20";
  std::uint32_t orbit = 0;  // number of images around the scene; 0: one image
  std::string path;         // file with the cameras of several images
  std::string size = "1280x720";
  ShadingOptions shading;
  CaptureJob capture;
};

SceneOrder draw_order(OrderImage image) {
  if (image == OrderImage::original) return SceneOrder::original;
  return image == OrderImage::centroid ? SceneOrder::centroid : SceneOrder::buffers;
}

void require_orders(const Scene& scene, const std::string& path) {
  for (const CleanPrimitive& primitive : scene.primitives) {
    if (primitive.orders) return;
  }
  throw Error(ErrorKind::nothing_to_do, path + ": there are no orders in it: run pellucid order first");
}

// Returns the first option that a comparison of orders does not support, or an empty text. Such a comparison
// is drawn on the CPU with surfaces that all look the same.
std::string capture_option(const RenderCommand& options) {
  const CaptureJob& capture = options.capture;
  if (options.technique != cpu_technique().name) return "--technique " + options.technique;
  if (capture.options.effect != Effect::transparency)
    return "--effect " + render_effects()[static_cast<std::size_t>(capture.options.effect)].name;
  if (capture.surfaces != Surfaces::uniform) return "--surfaces file";
  if (!capture.animation.empty()) return "--animation";
  if (is_file_camera(options.camera)) return "--camera file:";
  if (options.orbit != 0) return "--orbit";
  if (!options.path.empty()) return "--path";
  if (!capture.deep.empty()) return "--deep";
  if (!capture.pixels.empty()) return "--pixel";
  return capture.options.samples != 1 ? "--samples" : "";
}

void refuse_options_without_effect(const RenderCommand& options) {
  const CaptureJob& capture = options.capture;
  const TechniqueInfo technique = technique_info(options.technique, "--technique", "");
  refuse_capture_options_without_effect(*options.command, capture, {technique});
  const bool on_device = technique.name != cpu_technique().name;
  const std::string no_device = "technique cpu draws without a device";
  const std::string captured = capture_option(options);
  const std::string judged = captured +
                             " is given: orders and shading by depth are drawn by technique cpu, as one "
                             "transparent image of uniform surfaces";
  const Effect effect = capture.options.effect;
  // With a memory budget, `auto` may take k-plus or variable-k, which have maps.
  const bool writes_maps = technique.uses(OptionGroup::maps) ||
                           (technique.uses(OptionGroup::importance) && capture.options.budget.bytes != 0);
  const bool shows_opacity = effect == Effect::transparency || effect == Effect::wireframe;
  const bool shows_surfaces = options.order != OrderImage::error;
  const std::string error_image = "--order error shows which pixels are wrong, and no surfaces";
  refuse_without_effect(
      *options.command,
      {needs("--frames", on_device, "technique cpu is not timed"), needs("--device", on_device, no_device),
       needs("--validation-layers", on_device, no_device),
       needs(
           "--maps", writes_maps,
           "technique " + technique.name +
               " does not use it; fixed-k, hybrid, k-plus and variable-k do, and auto with --device-memory"),
       needs("--order", captured.empty() || options.order == OrderImage::exact, judged),
       needs("--shading", captured.empty() || options.shading.shading == Shading::lit, judged),
       needs("--time", !capture.animation.empty(), "there is no --animation"),
       needs("--camera", options.path.empty(), "the cameras are those of --path"),
       needs("--alpha", shows_opacity || wants_fragments(capture), "the effect does not show opacity"),
       needs("--alpha", shows_surfaces, error_image), needs("--shading", shows_surfaces, error_image)});
}

void run_capture(const RenderCommand& options, Session& session) {
  if (!std::isfinite(options.capture.time))
    throw Error(ErrorKind::bad_argument, "--time: not a number of seconds");
  const Size size = parse_size(options.size);
  CaptureJob job = options.capture;
  job.input = options.input;
  job.output = options.output;
  job.camera_text = options.camera;
  if (options.orbit > 0) job.shots = orbit(options.camera, options.orbit);
  if (!options.path.empty()) job.shots = read_camera_path(options.path);
  const bool timed =
      std::any_of(job.shots.begin(), job.shots.end(), [](const Shot& shot) { return shot.time.has_value(); });
  if (timed && job.animation.empty())
    throw Error(ErrorKind::bad_argument, options.path + ": has times, which are those of --animation");
  job.options.technique = options.technique;
  job.look = {options.shading.color, options.shading.alpha};
  job.width = size.width;
  job.height = size.height;
  render_capture(job, session);
}

void run_render(const RenderCommand& options, Session& session) {
  refuse_options_without_effect(options);
  check_writable(options.output);
  if (!options.capture.deep.empty()) check_writable(options.capture.deep);
  session.check_json();
  if (!capture_option(options).empty()) return run_capture(options, session);
  const Stopwatch watch;
  const Size size = parse_size(options.size);
  const Viewpoint viewpoint = parse_camera(options.camera);
  const Model model = open_model(options.input, session);
  const Scene scene = make_scene(model);
  if (options.order == OrderImage::buffers || options.order == OrderImage::error) {
    require_orders(scene, options.input);
  }
  stop_if_signalled();
  const Camera camera =
      camera_from(options.camera, options.capture.lens, model, scene, size.width, size.height);
  const FragmentBuffer fragments = scene_fragments(scene, camera);
  stop_if_signalled();

  const std::uint64_t covered = fragments.covered_pixels();
  PixelCount wrong{covered, 0};
  Image image;
  if (options.order == OrderImage::exact) {
    image = shade_exact(scene.mesh, camera, fragments, options.shading);
  } else {
    const std::vector<std::uint32_t> ranks = scene_ranks(scene, draw_order(options.order), camera, viewpoint);
    wrong = count_incorrect_pixels(fragments, ranks);
    image = options.order == OrderImage::error
                ? error_image(fragments, ranks)
                : shade_ordered(scene.mesh, camera, fragments, ranks, options.shading);
  }
  write_png(image, options.output);

  const double ipr = covered == 0 ? 0 : static_cast<double>(wrong.incorrect) / static_cast<double>(covered);
  const double seconds = watch.seconds();
  session.print(fmt::format("{}: {}x{}, {}: {} fragments on {} pixels, wrong {}\n", options.output,
                            size.width, size.height, options.order_name,
                            format_count(fragments.fragments.size()), format_count(covered),
                            format_percent(ipr)));
  const nlohmann::ordered_json json = {{"schema", 1},
                                       {"version", library_version()},
                                       {"input", options.input},
                                       {"output", options.output},
                                       {"technique", options.technique},
                                       {"order", options.order_name},
                                       {"width", size.width},
                                       {"height", size.height},
                                       {"triangles", scene.mesh.triangles.size()},
                                       {"fragments", fragments.fragments.size()},
                                       {"covered_pixels", covered},
                                       {"incorrect_pixels", wrong.incorrect},
                                       {"ipr", ipr},
                                       {"seconds", {{"total", seconds}}},
                                       {"peak_rss_bytes", peak_rss_bytes()}};
  session.write_json(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace

void add_render_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<RenderCommand>();
  CLI::App* command = add_command(
      app, chosen, "render", "Draw an image of a file: all its fragments, folded by an effect",
      "  pellucid render goblet.glb -o exact.png\n"
      "  pellucid render ordered.glb -o buffers.png --order buffers --camera 120,-10,2.5\n"
      "  pellucid render ordered.glb -o wrong.png --order error --size 1024x1024\n"
      "  pellucid render bunny.ply -o depth.png --order original --shading depth\n"
      "  pellucid render bottles.glb -o all.png --technique sb --surfaces file\n"
      "  pellucid render fox.glb -o run.png --technique sb --surfaces file --animation Run --time 0.3\n"
      "  pellucid render bottles.glb -o turn.png --technique sb --orbit 36\n"
      "  pellucid render bottles.glb -o all.png --technique sb --deep all.exr --pixel 640,360\n"
      "  pellucid render parts.glb -o carved.png --technique f2b-2p --effect csg --csg difference",
      1, [options](Session& session) { run_render(*options, session); });
  RenderCommand& o = *options;
  o.command = command;
  command->add_option("FILE", o.input, "glTF, GLB, PLY, OBJ, STL or OFF")->required()->type_name("");
  command->add_option("--size", o.size, "WIDTHxHEIGHT")
      ->type_name("")
      ->capture_default_str()
      ->group(kImageGroup);
  add_choice(*command, "--order", o.order,
             {{"exact", OrderImage::exact},
              {"buffers", OrderImage::buffers},
              {"original", OrderImage::original},
              {"centroid", OrderImage::centroid},
              {"error", OrderImage::error}},
             "How fragments are blended (default exact); error: wrong pixels of the buffers in red")
      ->each([&o](const std::string& name) { o.order_name = name; })
      ->group(kImageGroup);
  add_choice(*command, "--shading", o.shading.shading, {{"lit", Shading::lit}, {"depth", Shading::depth}},
             "lit: lighting of a translucent surface (default); depth: depth as colour")
      ->group(kImageGroup);
  command->add_option("--alpha", o.shading.alpha, "Opacity of a face")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(kImageGroup);
  command->add_option("--technique", o.technique, "How fragments are captured (see pellucid techniques)")
      ->type_name("NAME")
      ->capture_default_str()
      ->group(kTechniqueGroup);
  add_capture_options(*command, o.capture);
  command
      ->add_option(
          "--camera", o.camera,
          "AZIMUTH,ELEVATION,DISTANCE in degrees and bounding radii (or inf); without a distance, the "
          "scene fills the image; or file:NAME or file:NUMBER of a camera of the file")
      ->type_name("")
      ->capture_default_str()
      ->group(kCameraGroup);
  add_lens_options(*command, o.capture.lens);
  CLI::Option* orbit =
      command
          ->add_option("--orbit", o.orbit,
                       "Number of images around the scene, from --camera on, each in a file of its own")
          ->check(CLI::Range(1, 100'000))
          ->type_name("N")
          ->group(kCameraGroup);
  command
      ->add_option("--path", o.path,
                   "Draw an image for every line of FILE: a camera, and optionally the time")
      ->excludes(orbit)
      ->type_name("FILE")
      ->group(kCameraGroup);
  command
      ->add_option("--animation", o.capture.animation, "Pose the scene by this animation, by name or number")
      ->type_name("NAME")
      ->group(kAnimationGroup);
  command->add_option("--time", o.capture.time, "Time in --animation, seconds")
      ->type_name("S")
      ->capture_default_str()
      ->group(kAnimationGroup);
  command->add_option("-o,--output", o.output, "The PNG to write")
      ->required()
      ->type_name("FILE")
      ->group(kOutputGroup);
  command
      ->add_option("--maps", o.capture.maps,
                   "Write importance.png, k.png and loss.png of a technique with a tail into this folder")
      ->type_name("FOLDER")
      ->group(kOutputGroup);
  command->add_option("--deep", o.capture.deep, "Write all fragments of all pixels as a deep OpenEXR file")
      ->type_name("FILE")
      ->group(kOutputGroup);
  command
      ->add_option("--pixel", o.capture.pixels, "Print all fragments of this pixel; several times for more")
      ->type_name("X,Y")
      ->take_all()
      ->allow_extra_args(false)
      ->group(kOutputGroup);
}

}  // namespace pellucid::cli
