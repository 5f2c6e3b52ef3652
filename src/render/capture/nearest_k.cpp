// The k nearest fragments of every pixel (KB). Keys (depth, id) go through a chain of 64-bit atomic minima,
// which needs no order of the fragments, unlike the k-buffer of Bavoil et al. (I3D 2007); a second pass over
// the fragments brings the colours. More rounds: nearest_rounds.h.
#include "buffer_techniques.h"

namespace pellucid::render {
namespace {

class NearestK final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 8 * frame.options.k * frame.pixels();
  }
  void allocate(Frame& frame) override {
    keys_ = frame.make_buffer("fragment keys", 8 * frame.options.k * frame.pixels());
    colors_ = frame.make_buffer("fragment colours", 4 * frame.options.k * frame.pixels());
  }
  void start(Frame& frame, Recorder& recorder) override {
    const std::uint32_t k = frame.options.k;
    recorder.bind(Slot::a, keys_);
    recorder.bind(Slot::c, colors_);
    recorder.fill(keys_, 0xFFFFFFFFU);
    recorder.barrier();
    frame.gather(recorder, "capture/nearest_keys.frag", {frame.effect, k});
    recorder.barrier();
    frame.gather(recorder, "capture/nearest_colors.frag", {frame.effect, k});
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute("resolve/keys.comp", {frame.effect, k}), frame.tiles_x(),
                      frame.tiles_y());
  }

 private:
  Buffer keys_, colors_;
};

}  // namespace

TechniqueEntry k_buffer() {
  return {{.name = "kb",
           .title = "the k nearest fragments of every pixel",
           .paper = "Bavoil et al. 2007",
           .exact = false,
           .captures = "the k nearest of a pixel",
           .passes_formula = "2",
           .bytes_formula = "12 K",
           .multisampled = true,
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<NearestK>()); }};
}

}  // namespace pellucid::render
