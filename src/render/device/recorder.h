// recorder.h - records the commands of a technique: geometry passes into attachments, compute kernels, and
// barriers.
//
// All images stay in the layout GENERAL, and barrier() makes everything before it visible to everything after
// it. Passes over a whole image are long, so finer barriers save no measurable time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/device/memory.h"
#include "render/device/ordered_attachments.h"
#include "render/device/pipeline.h"

namespace pellucid::render {

struct DrawRange;
struct GpuScene;

// Slots of the descriptor set, with the names of shaders/frame.glsl.
enum class Slot : std::uint32_t {
  frame,
  triangles,
  surfaces,
  counters,
  final_colors,
  state_front,
  state_group,
  dump,
  a,
  b,
  c,
  d,
  indices,
  positions,
  state_back,
  state_back_group,
  objects,
  e,
  attributes,
  textures,
  image_0,
  image_1,
  image_2,
  opaque
};

// The largest number of peeling rounds in one submission, and of timestamps: one at the beginning, two for
// the resolve of each round, and one at the end.
constexpr std::uint32_t kMostRounds = 8;
constexpr std::uint32_t kMostTimestamps = 2 + 2 * kMostRounds;

struct PushConstants {
  std::uint32_t first_triangle = 0;
  std::uint32_t round = 0;
  std::array<std::uint32_t, 4> p{};
};
static_assert(sizeof(PushConstants) <= kPushBytes);

struct Attachments {
  std::vector<const Image*> colors;
  const Image* depth = nullptr;
  // Clears colours to `clear_color`, depth to `clear_depth` and stencils to 0. Otherwise all are loaded.
  bool clear = true;
  bool load_depth = false;  // with `clear`: clears only the colours
  VkClearColorValue clear_color{};
  float clear_depth = 1;
  bool stencil = false;                 // use the stencil of `depth`
  bool number_stencils = false;         // with `clear`: stencils start at their layer + 2
  std::uint32_t width = 0, height = 0;  // of the pass
  std::uint32_t samples = 1;            // per pixel: copies of the band, below each other
  std::int32_t first_row = 0;           // of the band within the image
  std::uint32_t image_height = 0;
  std::uint32_t layers = 1;  // if more than 1, each layer gets one instance
};

// Boxes that are drawn one by one, each with a query. The result decides whether the box is drawn the next
// time.
struct QueriedBoxes {
  const Buffer& corners;  // eight per box
  const Buffer& indices;
  std::uint32_t index_count = 0;
  const Buffer& predicates;  // one word per box
  VkQueryPool queries = VK_NULL_HANDLE;
  std::uint32_t count = 0;
};

// Triangles that the device has chosen: for each range of the scene the first ones, as many as the arguments
// of its draw say.
struct SomeTriangles {
  const Buffer& indices;
  const Buffer& arguments;  // VkDrawIndexedIndirectCommand of each range
};

class Recorder {
 public:
  // All buffer slots hold `unused` until something else is bound. `timestamps` has kMostTimestamps queries.
  Recorder(Context& context, VkCommandBuffer commands, const Buffer& unused, VkQueryPool timestamps);

  void bind(Slot slot, const Buffer& buffer);
  void bind(Slot slot, const Image& image);
  void bind_stencil(Slot slot, const Image& image);
  PushConstants& push() { return push_; }

  // Prepares an image for its first use.
  void prepare(const Image& image);
  void barrier();
  void barrier_to_host();  // makes everything visible to the host after the submission
  void fill(const Buffer& buffer, std::uint32_t word);
  void fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes);

  // Draws one geometry pass: all triangles of the scene, or some of them.
  void draw(const GpuScene& scene, const ScenePipeline& pipeline, const Attachments& attachments,
            const SomeTriangles* some = nullptr);
  // Does the same into ordered attachments, whose words all start as 0xFFFFFFFF.
  void draw_ordered(const GpuScene& scene, const ScenePipeline& pipeline, const OrderedTarget& target,
                    const Attachments& window);
  // Makes later calls of draw() draw these groups instead of the ranges of the scene. A group is drawn only
  // if its word in `predicates` is not 0.
  void draw_groups(std::span<const DrawRange> groups, const Buffer& predicates);
  // Draws the far sides of boxes; winding culls the near sides. push.p0 is the number of the box.
  void draw_boxes(const QueriedBoxes& boxes, const ScenePipeline& pipeline, const Attachments& attachments);
  void dispatch(const OwnedPipeline& pipeline, std::uint32_t groups_x, std::uint32_t groups_y);
  // Dispatches as many groups as the three words at `offset` say.
  void dispatch_indirect(const OwnedPipeline& pipeline, const Buffer& arguments, std::uint64_t offset);
  void count_fullscreen_pass() { ++fullscreen_passes_; }

  void begin_time();
  // Marks the time from here to end_resolve() or end_time() as sorting and folding.
  void begin_resolve();
  void end_resolve();
  void end_time();
  [[nodiscard]] std::uint32_t timestamps() const { return used_timestamps_; }

  // Skips draws and dispatches up to end_if() if the word at `index` is 0. Draws by draw_groups() are not
  // affected.
  void begin_if(const Buffer& predicates, std::size_t index);
  void end_if();
  void copy_word(const Buffer& from, std::uint64_t from_offset, const Buffer& to, std::uint64_t to_offset);

  [[nodiscard]] std::uint32_t geometry_passes() const { return geometry_passes_; }
  [[nodiscard]] std::uint32_t fullscreen_passes() const { return fullscreen_passes_; }

 private:
  void push_state(VkPipelineBindPoint point);
  void push_words();
  void draw_triangles(const GpuScene& scene, const ScenePipeline& pipeline, std::uint32_t layers,
                      const SomeTriangles* some);
  void set_window(const Attachments& attachments, std::uint32_t sample);
  // Calls `draw` with the window of each sample in turn.
  template <class Draw>
  void for_each_sample(const Attachments& attachments, const Draw& draw) {
    for (std::uint32_t sample = 0; sample < attachments.samples; ++sample) {
      set_window(attachments, sample);
      draw();
    }
  }
  void bind_range(const DrawRange& range, const ScenePipeline& pipeline);
  void draw_range(const DrawRange& range, const ScenePipeline& pipeline, std::uint32_t layers);
  void write_timestamp();
  void number_stencils(const VkRect2D& area, std::uint32_t layers);

  Context& context_;
  VkCommandBuffer commands_;
  VkQueryPool timestamps_;
  std::uint32_t used_timestamps_ = 0;
  bool resolves_ = false;
  std::span<const DrawRange> groups_;
  const Buffer* predicates_ = nullptr;
  PushConstants push_;
  std::array<VkDescriptorBufferInfo, kFirstImageSlot> buffers_{};
  std::array<VkDescriptorImageInfo, kSlots - kFirstImageSlot> images_{};
  std::uint32_t geometry_passes_ = 0, fullscreen_passes_ = 0;
};

}  // namespace pellucid::render
