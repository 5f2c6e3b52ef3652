// Front-to-back peeling with the depth test. Each round finds the next layer and stores its fragments. If a
// layer has more fragments than a round can store, the next round continues with it.
//
// Based on: Everitt, "Interactive Order-Independent Transparency", 2001 (F2B); sections 3.1.1, 3.1.3 and
// 3.2.1 of the paper. Corrected: as printed, F2B-3P also counted fragments of the last layer, F2B-KB took
// colours of 0 for empty places, and the counter of F2B-FAB wrapped around.
#include <fmt/format.h>

#include "render/capture/peeling/layer_fold.h"
#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

class FrontToBack final : public Technique {
 public:
  // With `depth_first`, one pass finds the depth, and a second pass shades only the fragments at this depth.
  FrontToBack(LayerStorage storage, bool depth_first) : storage_(storage), depth_first_(depth_first) {}

  [[nodiscard]] bool peels() const override { return true; }
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return fold_.largest_buffer(frame);
  }

  void allocate(Frame& frame) override {
    for (Image& depth : depths_) depth = frame.make_image("depth of a layer", VK_FORMAT_D32_SFLOAT);
    if (storage_ == LayerStorage::image) found_ = frame.make_image("layer", VK_FORMAT_R32G32_UINT);
    fold_.allocate(frame);
  }

  void start(Frame& /*frame*/, Recorder& recorder) override {
    for (const Image& depth : depths_) recorder.prepare(depth);
    if (found_) recorder.prepare(found_);
    fold_.clear(recorder);
  }

  void peel(Frame& frame, Recorder& recorder, std::uint32_t round) override {
    const Image& depth = depths_.at(round % 2);
    fold_.begin_round(frame, recorder, round);
    recorder.bind(Slot::image_0, depths_.at((round + 1) % 2));
    recorder.bind(Slot::image_1, depth);
    if (found_) recorder.bind(Slot::image_2, found_);
    if (depth_first_) {
      find_depth(frame, recorder, depth);
      recorder.barrier();
    }
    if (found_) {
      draw_image(frame, recorder, depth);
      recorder.barrier();
    } else {
      const std::uint32_t passes = storage_ == LayerStorage::pairs ? 2 : 1;
      for (std::uint32_t pass = 0; pass < passes; ++pass) {
        store(frame, recorder, depth, pass);
        recorder.barrier();
      }
    }
    fold_.fold(frame, recorder);
  }

  [[nodiscard]] std::string_view box_shader() const override { return "capture/peeling/box_left_image.frag"; }
  void finish(Frame& frame, Recorder& recorder) override { fold_.finish(frame, recorder); }

 private:
  void find_depth(const Frame& frame, Recorder& recorder, const Image& depth) const {
    const bool resumes = storage_ == LayerStorage::pairs || storage_ == LayerStorage::chains;
    Attachments attachments = frame.attachments();
    attachments.depth = &depth;
    recorder.draw(
        frame.scene,
        frame.pipelines.scene({.fragment_shader = resumes ? "capture/peeling/peel_depth_resumes.frag"
                                                          : "capture/peeling/peel_depth.frag",
                               .depth = VK_FORMAT_D32_SFLOAT,
                               .depth_test = DepthTest::less_or_equal,
                               .depth_write = true}),
        attachments);
  }

  void draw_image(const Frame& frame, Recorder& recorder, const Image& depth) const {
    Attachments attachments = frame.attachments();
    attachments.colors = {&found_};
    attachments.depth = &depth;
    attachments.load_depth = depth_first_;
    recorder.draw(
        frame.scene,
        frame.pipelines.scene({.fragment_shader = "capture/peeling/peel_image.frag",
                               .constants = {frame.effect},
                               .colors = {VK_FORMAT_R32G32_UINT},
                               .depth = VK_FORMAT_D32_SFLOAT,
                               .depth_test = depth_first_ ? DepthTest::equal : DepthTest::less_or_equal,
                               .depth_write = !depth_first_}),
        attachments);
  }

  void store(const Frame& frame, Recorder& recorder, const Image& depth, std::uint32_t pass) const {
    Attachments attachments = frame.attachments();
    attachments.depth = &depth;
    attachments.clear = false;
    const std::string shader = fmt::format("capture/peeling/peel_equal_{}.frag", fold_.shader_suffix());
    recorder.draw(frame.scene,
                  frame.pipelines.scene({.fragment_shader = shader,
                                         .constants = fold_.constants(frame, pass),
                                         .depth = VK_FORMAT_D32_SFLOAT,
                                         .depth_test = DepthTest::equal}),
                  attachments);
  }

  LayerStorage storage_;
  bool depth_first_;
  LayerFold fold_{{.storage = storage_}};
  std::array<Image, 2> depths_;  // of this round and of the last one, alternating
  Image found_;
};

template <LayerStorage storage, bool depth_first>
std::unique_ptr<Technique> make_front_to_back() {
  return std::make_unique<FrontToBack>(storage, depth_first);
}

}  // namespace

TechniqueEntry f2b() {
  return {{.name = "f2b",
           .title = "front-to-back peeling",
           .paper = "Everitt 2001",
           .exact = false,
           .order_free = false,
           .captures = "of fragments at one depth, the one drawn last",
           .passes_formula = "D + 1",
           .bytes_formula = "48",
           .groups = {OptionGroup::culling}},
          make_front_to_back<LayerStorage::image, false>};
}

TechniqueEntry f2b2() {
  return {{.name = "f2b2",
           .title = "front-to-back peeling, depth before colour",
           .paper = "Everitt 2001",
           .exact = false,
           .order_free = false,
           .captures = "of fragments at one depth, the one drawn last",
           .passes_formula = "2 (D + 1)",
           .bytes_formula = "48",
           .groups = {OptionGroup::culling}},
          make_front_to_back<LayerStorage::image, true>};
}

TechniqueEntry f2b_3p() {
  return {{.name = "f2b-3p",
           .title = "front-to-back peeling with a depth pass, two coplanar fragments a round",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all",
           .passes_formula = "3 (sum of ceil(C / 2) + 1)",
           .bytes_formula = "104",
           .groups = {OptionGroup::culling}},
          make_front_to_back<LayerStorage::pairs, true>};
}

TechniqueEntry f2b_ll() {
  return {{.name = "f2b-ll",
           .title = "front-to-back peeling, a linked list for every layer",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all that the pool has room for",
           .passes_formula = "2 (D + 1)",
           .bytes_formula = "12 N + 48",
           .groups = {OptionGroup::pool, OptionGroup::overflow, OptionGroup::culling}},
          make_front_to_back<LayerStorage::lists, true>};
}

TechniqueEntry f2b_kb() {
  return {{.name = "f2b-kb",
           .title = "front-to-back peeling, k coplanar fragments a round in the order of their ids",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all",
           .passes_formula = "2 (sum of ceil(C / K) + 1)",
           .bytes_formula = "8 K + 52",
           .groups = {OptionGroup::k, OptionGroup::culling},
           .needs_atomics64 = true},
          make_front_to_back<LayerStorage::chains, true>};
}

TechniqueEntry f2b_fab() {
  return {{.name = "f2b-fab",
           .title = "front-to-back peeling, an array of k fragments for every layer",
           .paper = "Vasilakis, Fudos 2014",
           .exact = false,
           .order_free = false,
           .captures = "of more than k fragments at one depth, those drawn first",
           .passes_formula = "2 (D + 1)",
           .bytes_formula = "8 K + 48",
           .groups = {OptionGroup::k, OptionGroup::culling}},
          make_front_to_back<LayerStorage::arrays, true>};
}

}  // namespace pellucid::render
