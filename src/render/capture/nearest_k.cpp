// The k nearest fragments of every pixel (KB), and the same again from where the last round ended until all
// are there (MultiKB): exact in memory that does not depend on the scene. Keys (depth, id) go through a chain
// of 64-bit atomic minima, which needs no order of the fragments, unlike the k-buffer of Bavoil et al. (I3D
// 2007), and no second try, unlike that of Liu et al. (2009); a second pass over the fragments brings the
// colours.
#include <cstddef>

#include "buffer_techniques.h"

namespace pellucid::render {
namespace {

class NearestK final : public Technique {
 public:
  explicit NearestK(bool several_rounds) : several_rounds_(several_rounds) {}

  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return std::max<std::uint64_t>(8 * frame.options.k, 32) * frame.pixels();
  }
  void allocate(Frame& frame) override {
    keys_ = frame.make_buffer("fragment keys", 8 * frame.options.k * frame.pixels());
    colors_ = frame.make_buffer("fragment colours", 4 * frame.options.k * frame.pixels());
    last_ = frame.make_buffer("last keys", several_rounds_ ? 8 * frame.pixels() : 0);
    states_ = frame.make_buffer("states", several_rounds_ ? 32 * frame.pixels() : 0);
  }
  void start(Frame& frame, Recorder& recorder) override {
    recorder.barrier();
    if (!several_rounds_) draw_round(frame, recorder, 0);
  }
  [[nodiscard]] bool peels() const override { return several_rounds_; }
  void peel(Frame& frame, Recorder& recorder, std::uint32_t round) override {
    draw_round(frame, recorder, round);
  }

 private:
  void draw_round(Frame& frame, Recorder& recorder, std::uint32_t round) {
    const std::uint32_t k = frame.options.k;
    recorder.bind(Slot::a, keys_);
    recorder.bind(Slot::b, last_);
    recorder.bind(Slot::c, colors_);
    recorder.bind(Slot::state_front, states_);
    recorder.push().round = round;
    recorder.fill(frame.counters, 0, offsetof(Counters, active_pixels), sizeof(std::uint32_t));
    recorder.dispatch(frame.pipelines.compute("capture/clear_keys.comp", {frame.effect, k, 0}),
                      frame.tiles_x(), frame.tiles_y());
    recorder.barrier();
    frame.gather(recorder, "capture/nearest_keys.frag", {frame.effect, k});
    recorder.barrier();
    frame.gather(recorder, "capture/nearest_colors.frag", {frame.effect, k});
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(
        frame.pipelines.compute("resolve/keys.comp", {frame.effect, k, several_rounds_ ? 1U : 0U}),
        frame.tiles_x(), frame.tiles_y());
  }

  bool several_rounds_;
  Buffer keys_, colors_, last_, states_;
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
          [] { return std::unique_ptr<Technique>(std::make_unique<NearestK>(false)); }};
}

TechniqueEntry multi_k_buffer() {
  return {{.name = "multikb",
           .title = "the k nearest fragments a round, until all are there",
           .paper = "Liu et al. 2009",
           .captures = "all",
           .passes_formula = "2 (floor(N / K) + 1)",
           .bytes_formula = "12 K + 40",
           .multisampled = true,
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<NearestK>(true)); }};
}

}  // namespace pellucid::render
