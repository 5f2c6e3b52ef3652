// frame.h - an image, or a band of it, while it is drawn. It has the counts of its fragments, the pipelines,
// and the memory and passes that techniques ask for.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "render/device/recorder.h"
#include "render/scene/gpu_scene.h"

namespace pellucid::render {

// A value of kEffect beyond the public effects. It delivers the fragments themselves
// (shaders/resolve/effects.glsl).
constexpr std::uint32_t kDumpEffect = 7;

// The bytes of the state of an effect in memory (shaders/resolve/effects.glsl).
constexpr std::uint64_t kStateBytes = 32;

// Tests that the fragments of a pass need: kFeatures of shaders/frame.glsl.
enum Feature : std::uint32_t {
  behind_opaque = 1,  // drop fragments behind opaque surfaces
  colored = 2,        // vertices have colours or texture coordinates
  cut_out = 4,        // drop fragments where a texture leaves too little opacity
};

// Makes pipelines on demand and keeps them as long as the device.
class Pipelines {
 public:
  explicit Pipelines(Context& context) : context_(context) {}
  // Sets the features of all pipelines that are requested from now on: a sum of Feature.
  void use_features(std::uint32_t features) { features_ = features; }
  const OrderedLayout& ordered(std::uint32_t attachments);
  const ScenePipeline& scene(const GraphicsSpec& spec);
  const OwnedPipeline& compute(std::string_view shader, const Constants& constants);

 private:
  [[nodiscard]] Constants with_features(Constants constants) const;

  Context& context_;
  std::uint32_t features_ = 0;
  std::map<std::uint32_t, OrderedLayout> ordered_;
  std::map<std::string, ScenePipeline> scene_;
  std::map<std::string, OwnedPipeline> compute_;
};

// The counters of shaders/counters.glsl.
struct Counters {
  std::uint32_t next_node, next_back, captured, coplanar, overflowed, active_pixels, rounds, covered, deepest,
      coplanar_pixels, misordered_pixels;
};

struct Frame {
  Context& context;
  Pipelines& pipelines;
  const GpuScene& scene;
  const RenderOptions& options;
  std::uint32_t effect = 0;     // kEffect
  Sync sync = Sync::automatic;  // for techniques that have a choice
  // The size of the band. With several samples per pixel, the band is repeated below itself for each sample.
  std::uint32_t width = 0, height = 0;
  std::uint32_t first_row = 0, image_height = 0;  // where the band lies in the image
  std::uint64_t fragments = 0, deepest = 0;       // in the band, counted beforehand
  std::span<const std::uint32_t> counts{};        // fragments of every pixel
  std::uint64_t covered = 0;                      // pixels with fragments
  std::uint64_t seen = 0;                         // pixels with fragments in any sample
  Buffer counters;
  // What techniques keep for the next frame of this band (shaders/capture/k_buffers/fold_places.comp).
  Buffer* residue = nullptr;
  std::uint64_t technique_bytes = 0;

  [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  // Returns the index of a sample of a pixel among pixels().
  [[nodiscard]] std::uint64_t sample_at(std::uint64_t pixel, std::uint32_t sample) const {
    return sample * (pixels() / options.samples) + pixel;
  }
  // Returns the number of nodes of a pool.
  [[nodiscard]] std::uint64_t capacity() const {
    return options.pool.nodes != 0 ? std::min(options.pool.nodes, std::max<std::uint64_t>(fragments, 1))
                                   : fragments;
  }
  [[nodiscard]] std::uint32_t tiles_x() const { return (width + 7) / 8; }
  [[nodiscard]] std::uint32_t tiles_y() const { return (height + 7) / 8; }
  [[nodiscard]] std::uint64_t tiles() const { return std::uint64_t{tiles_x()} * tiles_y(); }

  // Make the memory of a technique, which is counted in technique_bytes.
  Buffer make_buffer(const std::string& name, std::uint64_t bytes);
  Image make_image(const std::string& name, VkFormat format, std::uint32_t layers = 1,
                   ImageUse use = ImageUse::attachment);
  [[nodiscard]] ImageSpec image_spec(VkFormat format, std::uint32_t layers, ImageUse use) const {
    return {.format = format, .width = width, .height = height, .layers = layers, .use = use};
  }

  // Draw a geometry pass without attachments, and return the attachments for one with them.
  void gather(Recorder& recorder, std::string_view fragment_shader, const Constants& constants) const;
  [[nodiscard]] Attachments attachments() const;
  // Draws a pass into ordered attachments, which are the layers of an image.
  void gather_in_order(Recorder& recorder, std::string_view fragment_shader, const Constants& constants,
                       const Image& layers, const OrderedTarget& target) const;
};

// The data of shaders/frame.glsl (std430).
struct FrameData {
  std::array<float, 16> clip_from_world{};
  std::array<float, 4> eye{}, to_viewer{}, fill_light{}, background{}, planes{};
  std::array<std::uint32_t, 2> size{};
  std::uint32_t objects = 0, capacity = 0;
  std::array<float, 4> line{};
  std::uint32_t first_row = 0, csg = 0, samples = 1, unused = 0;
};
static_assert(sizeof(FrameData) == 192);

FrameData frame_data(const Camera& camera, const Frame& frame);

// Returns the number of turns that all loops of a shader may make together (docs/rendering.md).
std::uint32_t loop_budget(const DeviceInfo& device);

}  // namespace pellucid::render
