// S-buffer: counts the fragments of every pixel, reserves a contiguous range of exactly that size, and fills
// it. Based on: Vasilakis, Fudos, "S-buffer: Sparsity-aware Multi-fragment Rendering", Eurographics 2012 (SB
// of the paper).
#include "render/capture/registry.h"
#include "render/resolve/list_resolve.h"

namespace pellucid::render {
namespace {

class SBuffer final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return std::max(12 * frame.capacity(), 4 * frame.pixels());
  }
  [[nodiscard]] std::uint64_t most_bytes(const Frame& frame) const override {
    return 8 * frame.pixels() + 12 * frame.capacity() + ListResolve::bytes(frame);
  }
  void allocate(Frame& frame) override {
    counts_ = frame.make_buffer("fragment counts", 4 * frame.pixels());
    ends_ = frame.make_buffer("fragment ranges", 4 * frame.pixels());
    nodes_ = frame.make_buffer("fragment pool", 12 * frame.capacity());
    resolve_.allocate(frame);
  }
  void start(Frame& frame, Recorder& recorder) override {
    recorder.bind(Slot::a, counts_);
    recorder.bind(Slot::b, ends_);
    recorder.bind(Slot::c, nodes_);
    recorder.push().p[3] = static_cast<std::uint32_t>(frame.capacity());
    recorder.fill(counts_, 0);
    recorder.barrier();
    frame.gather(recorder, "capture/count.frag", {});
    recorder.barrier();
    recorder.dispatch(frame.pipelines.compute("capture/buffers/offsets.comp", {}), frame.tiles_x(),
                      frame.tiles_y());
    recorder.barrier();
    frame.gather(recorder, "capture/buffers/fill_ranges.frag", {frame.effect});
    recorder.barrier();
    resolve_.record(frame, recorder, 0);
  }

 private:
  Buffer counts_, ends_, nodes_;
  ListResolve resolve_{"ranges"};
};

}  // namespace

TechniqueEntry s_buffer() {
  return {{.name = "sb",
           .title = "S-buffer: a range of exactly the right size for every pixel",
           .paper = "Vasilakis, Fudos 2012",
           .captures = "all that the pool has room for",
           .passes_formula = "2",
           .bytes_formula = "12 N + 8",
           .groups = {OptionGroup::pool, OptionGroup::overflow, OptionGroup::sorting},
           .pooled = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<SBuffer>()); }};
}

}  // namespace pellucid::render
