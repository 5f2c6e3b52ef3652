// frame.h - an image, or a band of it, while it is drawn: what was counted of it, the pipelines, and the
// memory and passes that techniques may ask for.
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

// kEffect beyond the public effects: deliver the fragments themselves (shaders/resolve/effects.glsl).
constexpr std::uint32_t kDumpEffect = 7;

// Of an effect's state in memory (shaders/resolve/effects.glsl).
constexpr std::uint64_t kStateBytes = 32;

// What the fragments of a pass have to be looked at for: kFeatures of shaders/frame.glsl.
enum Feature : std::uint32_t {
  behind_opaque = 1,  // those behind opaque surfaces are none
  colored = 2,        // vertices have colours or texture coordinates
  cut_out = 4,        // those where a texture leaves too little opacity are none
};

// Pipelines are made once and kept as long as the device.
class Pipelines {
 public:
  explicit Pipelines(Context& context) : context_(context) {}
  // Of all that is asked for from now on: a sum of Feature.
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

// shaders/counters.glsl
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
  Sync sync = Sync::automatic;  // of techniques that have a choice
  // Of the band; with several samples of a pixel, of as many copies of it below each other.
  std::uint32_t width = 0, height = 0;
  std::uint32_t first_row = 0, image_height = 0;  // where it lies
  std::uint64_t fragments = 0, deepest = 0;       // in it, counted beforehand
  std::span<const std::uint32_t> counts{};        // of every pixel
  std::uint64_t covered = 0;                      // of them, those with fragments
  std::uint64_t seen = 0;                         // pixels with fragments in any sample
  Buffer counters;
  Buffer* residue = nullptr;  // what techniques keep for the next frame of this band
                              // (shaders/capture/k_buffers/fold_places.comp)
  std::uint64_t technique_bytes = 0;

  [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  // Where a sample of a pixel of the band lies among pixels().
  [[nodiscard]] std::uint64_t sample_at(std::uint64_t pixel, std::uint32_t sample) const {
    return sample * (pixels() / options.samples) + pixel;
  }
  // Nodes of a pool.
  [[nodiscard]] std::uint64_t capacity() const {
    return options.pool.nodes != 0 ? std::min(options.pool.nodes, std::max<std::uint64_t>(fragments, 1))
                                   : fragments;
  }
  [[nodiscard]] std::uint32_t tiles_x() const { return (width + 7) / 8; }
  [[nodiscard]] std::uint32_t tiles_y() const { return (height + 7) / 8; }
  [[nodiscard]] std::uint64_t tiles() const { return std::uint64_t{tiles_x()} * tiles_y(); }

  // A technique's own memory, which is counted.
  Buffer make_buffer(const std::string& name, std::uint64_t bytes);
  Image make_image(const std::string& name, VkFormat format, std::uint32_t layers = 1,
                   ImageUse use = ImageUse::attachment);
  [[nodiscard]] ImageSpec image_spec(VkFormat format, std::uint32_t layers, ImageUse use) const {
    return {.format = format, .width = width, .height = height, .layers = layers, .use = use};
  }

  // A geometry pass without attachments, and one with.
  void gather(Recorder& recorder, std::string_view fragment_shader, const Constants& constants) const;
  [[nodiscard]] Attachments attachments() const;
  // A pass into ordered attachments, which are the layers of an image.
  void gather_in_order(Recorder& recorder, std::string_view fragment_shader, const Constants& constants,
                       const Image& layers, const OrderedTarget& target) const;
};

// shaders/frame.glsl, std430
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

// Turns that a shader's loops may make in all (docs/rendering.md).
std::uint32_t loop_budget(const DeviceInfo& device);

}  // namespace pellucid::render
