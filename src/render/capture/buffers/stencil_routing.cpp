// Stencil-routed A-buffer (SRAB): draws all triangles to k layers. The stencil of layer i starts at i + 2 and
// is decremented by every fragment. A layer keeps the fragment that finds its stencil at 2, so the n-th
// fragment in draw order goes to layer n.
//
// Based on: Myers, Bavoil, "Stencil Routed A-Buffer", SIGGRAPH 2007 sketches. Differs in: the k places of a
// pixel are layers of an array image. The paper uses the samples of a multisampled target. The positions of
// such samples differ, so edges get wrong fragments unless multisampling can be switched off, which Vulkan
// does not allow.
#include "render/capture/registry.h"
#include "render/resolve/list_resolve.h"

namespace pellucid::render {
namespace {

constexpr VkFormat kNodes = VK_FORMAT_R32G32B32A32_UINT;
constexpr VkFormat kStencil = VK_FORMAT_D32_SFLOAT_S8_UINT;

class StencilRouting final : public Technique {
 public:
  // Images do not count as buffers. This bounds the size of one layer.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 16 * frame.pixels();
  }
  void allocate(Frame& frame) override {
    nodes_ = frame.make_image("fragment layers", kNodes, frame.options.k);
    stencil_ = frame.make_image("stencil layers", kStencil, frame.options.k);
    resolve_.allocate(frame);
  }
  void start(Frame& frame, Recorder& recorder) override {
    const std::uint32_t k = frame.options.k;
    recorder.prepare(nodes_);
    recorder.prepare(stencil_);
    recorder.bind(Slot::image_0, nodes_);
    Attachments attachments = frame.attachments();
    attachments.colors = {&nodes_};
    attachments.depth = &stencil_;
    attachments.stencil = true;
    attachments.number_stencils = true;
    attachments.layers = k;
    recorder.draw(frame.scene,
                  frame.pipelines.scene({.fragment_shader = "capture/buffers/route_layers.frag",
                                         .constants = {frame.effect, k},
                                         .colors = {kNodes},
                                         .depth = kStencil,
                                         .vertex_shader = "scene/scene_layered.vert",
                                         .stencil = Stencil::route}),
                  attachments);
    recorder.barrier();
    resolve_.record(frame, recorder, k);
  }

 private:
  Image nodes_, stencil_;
  ListResolve resolve_{"layers"};
};

}  // namespace

TechniqueEntry stencil_routing() {
  return {{.name = "srab",
           .title = "k layers, the stencil test routes the n-th fragment to the n-th",
           .paper = "Myers, Bavoil 2007",
           .exact = false,
           .order_free = false,
           .captures = "of a pixel with more than k fragments, those drawn first",
           .passes_formula = "1, to K layers",
           .bytes_formula = "24 K",
           .groups = {OptionGroup::k, OptionGroup::sorting},
           .needs_layered = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<StencilRouting>()); }};
}

}  // namespace pellucid::render
