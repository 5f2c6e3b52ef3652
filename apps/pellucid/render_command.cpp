// pellucid render: one picture of a file: its fragments captured by a technique and folded by an effect, or
// drawn as one of its orders draws it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "camera_options.h"
#include "capture_options.h"
#include "capture_picture.h"
#include "choice.h"
#include "deep_pixels.h"
#include "pellucid/asset.h"
#include "pellucid/metric.h"
#include "pellucid/report.h"
#include "pellucid/scene.h"
#include "session.h"

namespace pellucid::cli {
namespace {

enum class OrderPicture { exact, buffers, original, centroid, error };

struct RenderCommand {
  std::string input, output;
  std::string technique = "cpu";
  OrderPicture picture = OrderPicture::exact;
  std::string picture_name = "exact";
  std::string camera = "30,20,3";
  std::uint32_t orbit = 0;  // pictures round the scene; 0: one
  std::string path;         // cameras of several pictures
  std::string size = "1280x720";
  ShadingOptions shading;
  CapturePicture capture;
};

SceneOrder draw_order(OrderPicture picture) {
  if (picture == OrderPicture::original) return SceneOrder::original;
  return picture == OrderPicture::centroid ? SceneOrder::centroid : SceneOrder::buffers;
}

void require_orders(const Scene& scene, const std::string& path) {
  for (const CleanPrimitive& primitive : scene.primitives) {
    if (primitive.orders) return;
  }
  throw Error(ErrorKind::nothing_to_do, path + ": there are no orders in it: run pellucid order first");
}

// Orders are judged on the CPU, by surfaces that all look the same.
bool draws_orders(const RenderCommand& options) {
  return options.technique == "cpu" && options.capture.options.effect == Effect::transparency &&
         options.capture.surfaces == Surfaces::uniform && options.capture.animation.empty() &&
         !is_file_camera(options.camera) && options.orbit == 0 && options.path.empty() &&
         options.capture.maps.empty() && !wants_fragments(options.capture) &&
         options.capture.options.samples == 1 && !options.capture.options.cull;
}

void run_capture(const RenderCommand& options, Session& session) {
  if (options.picture != OrderPicture::exact) {
    throw Error(ErrorKind::bad_argument, "--order " + options.picture_name +
                                             " is drawn with --technique cpu, --effect transparency and "
                                             "--surfaces uniform, one picture without --animation and "
                                             "--camera file:");
  }
  if (options.shading.shading != Shading::lit) {
    throw Error(ErrorKind::bad_argument,
                "--shading depth is drawn with --technique cpu and --effect transparency");
  }
  if (!std::isfinite(options.capture.time))
    throw Error(ErrorKind::bad_argument, "--time: not a number of seconds");
  const Size size = parse_size(options.size);
  CapturePicture picture = options.capture;
  picture.input = options.input;
  picture.output = options.output;
  picture.camera_text = options.camera;
  if (options.orbit > 0) picture.shots = orbit(options.camera, options.orbit);
  if (!options.path.empty()) picture.shots = read_camera_path(options.path);
  const bool timed = std::any_of(picture.shots.begin(), picture.shots.end(),
                                 [](const Shot& shot) { return shot.time.has_value(); });
  if (timed && picture.animation.empty())
    throw Error(ErrorKind::bad_argument, options.path + ": has times, which are those of --animation");
  picture.options.technique = options.technique;
  picture.look = {options.shading.color, options.shading.alpha};
  picture.width = size.width;
  picture.height = size.height;
  render_capture(picture, session);
}

void run_render(const RenderCommand& options, Session& session) {
  check_writable(options.output);
  if (!options.capture.deep.empty()) check_writable(options.capture.deep);
  session.check_json();
  if (!draws_orders(options)) return run_capture(options, session);
  const Stopwatch watch;
  const Size size = parse_size(options.size);
  const Viewpoint viewpoint = parse_camera(options.camera);
  const Scene scene = make_scene(read_model(options.input));
  if (options.picture == OrderPicture::buffers || options.picture == OrderPicture::error) {
    require_orders(scene, options.input);
  }
  stop_if_signalled();
  const Camera camera = look_at_sphere(scene.sphere, viewpoint, size.width, size.height);
  const FragmentBuffer fragments = scene_fragments(scene, camera);
  stop_if_signalled();

  const std::uint64_t covered = fragments.covered_pixels();
  PixelCount wrong{covered, 0};
  Image image;
  if (options.picture == OrderPicture::exact) {
    image = shade_exact(scene.mesh, camera, fragments, options.shading);
  } else {
    const std::vector<std::uint32_t> ranks =
        scene_ranks(scene, draw_order(options.picture), camera, viewpoint);
    wrong = count_incorrect_pixels(fragments, ranks);
    image = options.picture == OrderPicture::error
                ? error_image(fragments, ranks)
                : shade_ordered(scene.mesh, camera, fragments, ranks, options.shading);
  }
  write_png(image, options.output);

  const double ipr = covered == 0 ? 0 : static_cast<double>(wrong.incorrect) / static_cast<double>(covered);
  const double seconds = watch.seconds();
  session.print(fmt::format("{}: {}x{}, {}: {} fragments on {} pixels, wrong {}\n", options.output,
                            size.width, size.height, options.picture_name,
                            format_count(fragments.fragments.size()), format_count(covered),
                            format_percent(ipr)));
  const nlohmann::ordered_json json = {{"schema", 1},
                                       {"version", library_version()},
                                       {"input", options.input},
                                       {"output", options.output},
                                       {"technique", options.technique},
                                       {"order", options.picture_name},
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
      app, chosen, "render", "One picture of a file: all its fragments, folded by an effect",
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
  command->add_option("FILE", o.input, "glTF, GLB, PLY, OBJ, STL or OFF")->required()->type_name("");
  command->add_option("-o,--output", o.output, "The PNG to write")->required()->type_name("FILE");
  command->add_option("--technique", o.technique, "How fragments are gathered (see pellucid techniques)")
      ->type_name("NAME")
      ->capture_default_str();
  add_capture_options(*command, o.capture);
  add_choice(*command, "--order", o.picture,
             {{"exact", OrderPicture::exact},
              {"buffers", OrderPicture::buffers},
              {"original", OrderPicture::original},
              {"centroid", OrderPicture::centroid},
              {"error", OrderPicture::error}},
             "How fragments are blended (default exact); error: wrong pixels of the buffers in red")
      ->each([&o](const std::string& name) { o.picture_name = name; });
  command
      ->add_option("--camera", o.camera,
                   "AZIMUTH,ELEVATION,DISTANCE in degrees and bounding radii (or inf), or file:NAME or "
                   "file:NUMBER of a camera of the file")
      ->type_name("")
      ->capture_default_str();
  CLI::Option* orbit =
      command->add_option("--orbit", o.orbit, "So many pictures round the scene, from --camera on, numbered")
          ->check(CLI::Range(1, 100'000))
          ->type_name("N");
  command->add_option("--path", o.path, "A picture for every line of FILE: a camera, and maybe the time")
      ->excludes(orbit)
      ->type_name("FILE");
  CLI::Option* animation = command
                               ->add_option("--animation", o.capture.animation,
                                            "Pose the scene by this animation, by name or number")
                               ->type_name("NAME");
  command->add_option("--time", o.capture.time, "Seconds of --animation")
      ->needs(animation)
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--maps", o.capture.maps,
                   "Write importance.png, k.png and loss.png of a technique with --memory into this folder")
      ->type_name("FOLDER");
  command->add_option("--deep", o.capture.deep, "Write all fragments of all pixels as a deep OpenEXR file")
      ->type_name("FILE");
  command
      ->add_option("--pixel", o.capture.pixels, "Print all fragments of this pixel; several times for more")
      ->type_name("X,Y")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--size", o.size, "WIDTHxHEIGHT")->type_name("")->capture_default_str();
  add_choice(*command, "--shading", o.shading.shading, {{"lit", Shading::lit}, {"depth", Shading::depth}},
             "lit: lighting of a translucent surface (default); depth: depth as colour");
  command->add_option("--alpha", o.shading.alpha, "Opacity of a face")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

}  // namespace pellucid::cli
