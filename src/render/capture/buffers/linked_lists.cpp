// Linked lists: all fragments go to one pool with an atomic counter. A pixel has one list (LL), or one list
// for each of several uniform buckets of its depth range, so that the lists to sort are short (BUN-LL). Based
// on: Yang, Hensley, Gruen, Thibieroz, "Real-Time Concurrent Linked List Construction on the GPU", EGSR 2010;
// section 3.1.4 of the paper. Differs in: the buckets lie between the nearest and farthest fragment of the
// pixel instead of spanning the bounding box.
#include "render/capture/registry.h"
#include "render/resolve/list_resolve.h"

namespace pellucid::render {
namespace {

class LinkedLists final : public Technique {
 public:
  explicit LinkedLists(bool bucketed) : bucketed_(bucketed) {}

  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return std::max(16 * frame.capacity(), 4 * buckets(frame) * frame.pixels());
  }
  [[nodiscard]] std::uint64_t most_bytes(const Frame& frame) const override {
    return (4 * buckets(frame) + (bucketed_ ? 8 : 0)) * frame.pixels() + 16 * frame.capacity() +
           ListResolve::bytes(frame);
  }
  void allocate(Frame& frame) override {
    heads_ = frame.make_buffer("list heads", 4 * buckets(frame) * frame.pixels());
    bounds_ = frame.make_buffer("depth bounds", bucketed_ ? 8 * frame.pixels() : 0);
    nodes_ = frame.make_buffer("fragment pool", 16 * frame.capacity());
    resolve_.allocate(frame);
  }
  void start(Frame& frame, Recorder& recorder) override {
    const std::uint32_t k = buckets(frame);
    recorder.bind(Slot::a, heads_);
    recorder.bind(Slot::b, bounds_);
    recorder.bind(Slot::c, nodes_);
    recorder.fill(heads_, 0xFFFFFFFFU);
    if (bucketed_) {
      recorder.dispatch(frame.pipelines.compute("capture/buffers/clear_bounds.comp", {}), frame.tiles_x(),
                        frame.tiles_y());
      recorder.barrier();
      frame.gather(recorder, "capture/buffers/bounds.frag", {});
    }
    recorder.barrier();
    frame.gather(recorder, "capture/buffers/fill_lists.frag", {frame.effect, k});
    recorder.barrier();
    resolve_.record(frame, recorder, k);
  }

 private:
  [[nodiscard]] std::uint32_t buckets(const Frame& frame) const { return bucketed_ ? frame.options.k : 1; }

  bool bucketed_;
  Buffer heads_, bounds_, nodes_;
  ListResolve resolve_{"lists"};
};

}  // namespace

TechniqueEntry linked_lists() {
  return {{.name = "ll",
           .title = "a linked list for every pixel",
           .paper = "Yang et al. 2010",
           .captures = "all that the pool has room for",
           .passes_formula = "1",
           .bytes_formula = "16 N + 4",
           .groups = {OptionGroup::pool, OptionGroup::overflow, OptionGroup::sorting},
           .pooled = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<LinkedLists>(false)); }};
}

TechniqueEntry bucketed_lists() {
  return {{.name = "bun-ll",
           .title = "a linked list for every bucket of a pixel's depth range",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all that the pool has room for",
           .passes_formula = "2",
           .bytes_formula = "16 N + 4 K + 8",
           .groups = {OptionGroup::k, OptionGroup::pool, OptionGroup::overflow, OptionGroup::sorting},
           .pooled = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<LinkedLists>(true)); }};
}

}  // namespace pellucid::render
