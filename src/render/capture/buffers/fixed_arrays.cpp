// Fixed arrays: each pixel has an array for its first k fragments in draw order (FAB of the paper). Based on:
// Crassin, "Fast and Accurate Single-Pass A-Buffer", 2010; Liu et al., "FreePipe", I3D 2010.
#include "render/capture/registry.h"
#include "render/resolve/list_resolve.h"

namespace pellucid::render {
namespace {

class FixedArrays final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 12 * frame.options.k * frame.pixels();
  }
  void allocate(Frame& frame) override {
    counts_ = frame.make_buffer("fragment counts", 4 * frame.pixels());
    nodes_ = frame.make_buffer("fragment arrays", 12 * frame.options.k * frame.pixels());
    resolve_.allocate(frame);
  }
  void start(Frame& frame, Recorder& recorder) override {
    recorder.bind(Slot::a, counts_);
    recorder.bind(Slot::c, nodes_);
    recorder.fill(counts_, 0);
    recorder.barrier();
    frame.gather(recorder, "capture/buffers/fill_arrays.frag", {frame.effect, frame.options.k});
    recorder.barrier();
    resolve_.record(frame, recorder, frame.options.k);
  }

 private:
  Buffer counts_, nodes_;
  ListResolve resolve_{"arrays"};
};

}  // namespace

TechniqueEntry fixed_arrays() {
  return {{.name = "fab",
           .title = "an array of k fragments for every pixel",
           .paper = "Crassin 2010",
           .exact = false,
           .order_free = false,
           .captures = "of a pixel with more than k fragments, those drawn first",
           .passes_formula = "1",
           .bytes_formula = "12 K + 4",
           .groups = {OptionGroup::k, OptionGroup::sorting}},
          [] { return std::unique_ptr<Technique>(std::make_unique<FixedArrays>()); }};
}

}  // namespace pellucid::render
