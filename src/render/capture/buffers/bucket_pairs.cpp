// Bucket peeling: divides the depth range of a pixel into k buckets and keeps the nearest and the farthest
// fragment of each. The buckets are uniform (BUN), or have equally many occupied depth bins (BAD). Based on:
// Liu, Huang, Liu, Wu, "Efficient Depth Peeling via Bucket Sort", HPG 2009; Sintorn, Assarsson, I3D 2009.
// Differs in: keys (depth, id) and 64-bit atomics replace MAX blending, so that fragments of equal depth stay
// separate.
#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

class BucketPairs final : public Technique {
 public:
  explicit BucketPairs(bool adaptive) : adaptive_(adaptive) {}

  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    const std::uint64_t bins = adaptive_ ? 4 * (kWords + frame.options.k) : 0;
    return std::max<std::uint64_t>(16 * frame.options.k, bins) * frame.pixels();
  }
  void allocate(Frame& frame) override {
    const std::uint32_t k = frame.options.k;
    bounds_ = frame.make_buffer("depth bounds", 8 * frame.pixels());
    keys_ = frame.make_buffer("fragment keys", 16 * k * frame.pixels());
    colors_ = frame.make_buffer("fragment colours", 8 * k * frame.pixels());
    bins_ = frame.make_buffer("depth bins", adaptive_ ? 4 * (kWords + k) * frame.pixels() : 0);
  }
  void start(Frame& frame, Recorder& recorder) override {
    const std::uint32_t k = frame.options.k;
    const Constants constants{frame.effect, k, adaptive_ ? 1U : 0U};
    recorder.bind(Slot::a, keys_);
    recorder.bind(Slot::b, bounds_);
    recorder.bind(Slot::c, colors_);
    recorder.bind(Slot::d, bins_);
    recorder.fill(bins_, 0);
    recorder.barrier();
    recorder.dispatch(frame.pipelines.compute("capture/buffers/clear_bounds.comp", {}), frame.tiles_x(),
                      frame.tiles_y());
    recorder.dispatch(frame.pipelines.compute("capture/buffers/clear_keys.comp", {frame.effect, 2 * k}),
                      frame.tiles_x(), frame.tiles_y());
    recorder.barrier();
    frame.gather(recorder, "capture/buffers/bounds.frag", {});
    recorder.barrier();
    if (adaptive_) {
      frame.gather(recorder, "capture/buffers/depth_bins.frag", constants);
      recorder.barrier();
      recorder.dispatch(frame.pipelines.compute("capture/buffers/divide_bins.comp", constants),
                        frame.tiles_x(), frame.tiles_y());
      recorder.barrier();
    }
    frame.gather(recorder, "capture/buffers/pairs_keys.frag", constants);
    recorder.barrier();
    frame.gather(recorder, "capture/buffers/pairs_colors.frag", constants);
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute("resolve/keys.comp", {frame.effect, 2 * k}), frame.tiles_x(),
                      frame.tiles_y());
  }

 private:
  static constexpr std::uint64_t kWords = 32;  // hold one bit for each of 1,024 bins
  bool adaptive_;
  Buffer bounds_, keys_, colors_, bins_;
};

}  // namespace

TechniqueEntry uniform_buckets() {
  return {{.name = "bun",
           .title = "the nearest and the farthest of each of k uniform buckets",
           .paper = "Liu et al. 2009",
           .exact = false,
           .captures = "two of every bucket",
           .passes_formula = "3",
           .bytes_formula = "24 K + 8",
           .groups = {OptionGroup::k},
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<BucketPairs>(false)); }};
}

TechniqueEntry adaptive_buckets() {
  return {{.name = "bad",
           .title = "the nearest and the farthest of each of k buckets of equal occupation",
           .paper = "Liu et al. 2009",
           .exact = false,
           .captures = "two of every bucket",
           .passes_formula = "4",
           .bytes_formula = "28 K + 136",
           .groups = {OptionGroup::k},
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<BucketPairs>(true)); }};
}

}  // namespace pellucid::render
