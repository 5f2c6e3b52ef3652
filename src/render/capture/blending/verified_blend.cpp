// Order-verified blending: blends in draw order and captures exactly only the pixels where that order was
// wrong. In-depth orders are right in nearly all pixels.
//
// When a pixel is drawn from front to back, every fragment lies behind all fragments that were drawn before
// it. The depth test checks this. With GREATER and depth writes, a fragment that passes is blended under the
// others. A fragment that fails is nearer than an already blended one, or equally near, and it increments the
// stencil of its pixel, which marks it. Only marked pixels are captured by an S-buffer behind the stencil
// test and drawn anew, from the triangles that touch their tiles. The image is therefore exact for any draw
// order. Opaque surfaces are drawn first. Fragments behind them are discarded in the shader, so that they
// mark nothing.
#include "render/capture/registry.h"
#include "render/resolve/list_resolve.h"

namespace pellucid::render {
namespace {

constexpr VkFormat kDepthAndMarks = VK_FORMAT_D32_SFLOAT_S8_UINT;
constexpr std::uint64_t kNodeBytes = 12;

// Returns the index after the last triangle that is drawn.
std::uint64_t triangles_end(const GpuScene& scene) {
  std::uint64_t end = 0;
  for (const DrawRange& range : scene.ranges)
    end = std::max<std::uint64_t>(end, range.first_triangle + range.triangles);
  return end;
}

class VerifiedBlend final : public Technique {
 public:
  // Assumes that all pixels are marked.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return std::max(kNodeBytes * frame.fragments, 16 * frame.pixels());
  }
  [[nodiscard]] std::uint64_t most_bytes(const Frame& frame) const override {
    const std::uint64_t triangles = triangles_end(frame.scene);
    std::uint64_t targets = 0;
    for (const VkFormat format : {kBlended, kDepthAndMarks})
      targets += Image::bytes_needed(frame.context, frame.image_spec(format, 1, ImageUse::attachment));
    return targets + 8 * frame.pixels() + 4 * (3 + 2 * frame.tiles()) + 16 * triangles +
           frame.scene.ranges.size() * sizeof(VkDrawIndexedIndirectCommand) + kNodeBytes * frame.fragments +
           ListResolve::bytes(frame);
  }
  void allocate(Frame& frame) override {
    blended_ = frame.make_image("blended colours", kBlended);
    marks_ = frame.make_image("depths and marks", kDepthAndMarks);
    counts_ = frame.make_buffer("marked fragments", 4 * frame.pixels());
    ends_ = frame.make_buffer("marked ranges", 4 * frame.pixels());
    marked_tiles_ = frame.make_buffer("marked tiles", 4 * (3 + 2 * frame.tiles()));
    std::vector<VkDrawIndexedIndirectCommand> draws;
    for (const DrawRange& range : frame.scene.ranges)
      draws.push_back({.indexCount = 0, .instanceCount = 1, .firstIndex = 3 * range.first_triangle});
    const std::uint64_t triangles = triangles_end(frame.scene);
    triangles_ = frame.make_buffer("triangles of marked tiles", 4 * triangles);
    indices_ = frame.make_buffer("indices of marked tiles", 12 * triangles);
    arguments_ = frame.make_buffer("arguments of draws", draws.size() * sizeof draws[0]);
    upload<VkDrawIndexedIndirectCommand>(frame.context, arguments_, draws);
    resolve_.allocate(frame);
  }
  void start(Frame& frame, Recorder& recorder) override {
    blend(frame, recorder);
    choose_triangles(frame, recorder);
    count_marked(frame, recorder);
  }
  // The repair is a round of its own, because the memory that it takes is known only after start().
  [[nodiscard]] bool peels() const override { return true; }
  [[nodiscard]] std::uint64_t known_rounds() const override { return 1; }
  void allocate_rounds(Frame& frame) override {
    Counters counters{};
    frame.counters.download(frame.context, std::as_writable_bytes(std::span(&counters, 1)));
    marked_ = counters.next_node;
    if (marked_ > 0) nodes_ = frame.make_buffer("marked pool", kNodeBytes * marked_);
  }
  void peel(Frame& frame, Recorder& recorder, std::uint32_t /*round*/) override {
    if (marked_ > 0) repair(frame, recorder);
  }

  void report(const Frame& frame, std::span<const std::uint32_t> /*counts*/, RenderResult& result) override {
    std::vector<VkDrawIndexedIndirectCommand> draws(frame.scene.ranges.size());
    arguments_.download(frame.context, std::as_writable_bytes(std::span(draws)));
    for (const VkDrawIndexedIndirectCommand& draw : draws)
      result.stats.repaired_triangles += draw.indexCount / 3;
  }

 private:
  void blend(Frame& frame, Recorder& recorder) {
    recorder.prepare(blended_);
    recorder.prepare(marks_);
    Attachments attachments = frame.attachments();
    attachments.colors = {&blended_};
    attachments.depth = &marks_;
    attachments.stencil = true;
    attachments.clear_depth = 0;
    recorder.draw(frame.scene,
                  frame.pipelines.scene({.fragment_shader = "capture/blending/blend.frag",
                                         .constants = {frame.effect},
                                         .colors = {kBlended},
                                         .blend = Blend::under,
                                         .depth = kDepthAndMarks,
                                         .depth_test = DepthTest::greater,
                                         .depth_write = true,
                                         .stencil = Stencil::mark}),
                  attachments);
    recorder.fill(counts_, 0);
    recorder.fill(marked_tiles_, 0);
    recorder.barrier();
    recorder.fill(marked_tiles_, 1, 4, 8);  // y and z of the dispatch
    recorder.barrier();
    recorder.bind(Slot::image_0, blended_);
    recorder.bind_stencil(Slot::image_1, marks_);
    recorder.bind(Slot::d, marked_tiles_);
    recorder.dispatch(frame.pipelines.compute("capture/blending/finish_blended_marks.comp", {}),
                      frame.tiles_x(), frame.tiles_y());
    recorder.barrier();
  }

  // Chooses the triangles that may have fragments in marked pixels, so that only these are drawn again.
  void choose_triangles(Frame& frame, Recorder& recorder) {
    bind_triangles(recorder);
    const OwnedPipeline& kernel = frame.pipelines.compute("capture/blending/touching_triangles.comp", {});
    const std::vector<DrawRange>& ranges = frame.scene.ranges;
    for (std::uint32_t i = 0; i < ranges.size(); ++i) {
      constexpr std::uint32_t kGroup = 64;
      constexpr std::uint32_t kMostGroups = 65'535;
      const std::uint32_t groups = (ranges[i].triangles + kGroup - 1) / kGroup;
      recorder.push().first_triangle = ranges[i].first_triangle;
      recorder.push().p[0] = ranges[i].triangles;
      recorder.push().p[1] = i;
      recorder.dispatch(kernel, std::min(groups, kMostGroups), (groups + kMostGroups - 1) / kMostGroups);
    }
    recorder.barrier();
  }

  void bind_triangles(Recorder& recorder) const {
    recorder.bind(Slot::state_front, triangles_);
    recorder.bind(Slot::state_group, indices_);
    recorder.bind(Slot::state_back, arguments_);
  }

  void count_marked(Frame& frame, Recorder& recorder) {
    recorder.bind(Slot::a, counts_);
    recorder.bind(Slot::b, ends_);
    draw_marked(frame, recorder, "capture/count_marked.frag");
    recorder.barrier();
    recorder.dispatch_indirect(frame.pipelines.compute("capture/blending/reserve_marked.comp", {}),
                               marked_tiles_, 0);
  }

  void repair(Frame& frame, Recorder& recorder) {
    recorder.bind(Slot::a, counts_);
    recorder.bind(Slot::b, ends_);
    recorder.bind(Slot::c, nodes_);
    recorder.bind(Slot::d, marked_tiles_);
    bind_triangles(recorder);
    recorder.push().p[3] = marked_;
    draw_marked(frame, recorder, "capture/buffers/fill_ranges_marked.frag");
    recorder.barrier();
    resolve_.repair(frame, recorder, marked_tiles_);
  }

  void draw_marked(Frame& frame, Recorder& recorder, std::string_view shader) {
    Attachments attachments = frame.attachments();
    attachments.depth = &marks_;
    attachments.stencil = true;
    attachments.clear = false;
    const SomeTriangles some{indices_, arguments_};
    recorder.draw(frame.scene,
                  frame.pipelines.scene({.fragment_shader = shader,
                                         .constants = {frame.effect},
                                         .depth = kDepthAndMarks,
                                         .stencil = Stencil::marked}),
                  attachments, &some);
  }

  std::uint32_t marked_ = 0;  // number of fragments in marked pixels
  Image blended_, marks_;
  Buffer marked_tiles_, triangles_, indices_, arguments_;
  Buffer counts_, ends_, nodes_;
  ListResolve resolve_{"ranges"};
};

}  // namespace

TechniqueEntry verified_blend() {
  return {{.name = "verified",
           .title = "blending in draw order, checked by the depth test, repaired where it was wrong",
           .paper = "",
           .captures = "all",
           .passes_formula = "2, 3 where something is repaired",
           .bytes_formula = "32 + 12 N of repaired pixels",
           .groups = {OptionGroup::sorting},
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<VerifiedBlend>()); }};
}

}  // namespace pellucid::render
