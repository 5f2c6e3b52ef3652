// Peeling without the depth test, from the front of a pixel or from both ends. Each round stores the
// fragments in the current layers and finds the next layers between them. The first round only finds layers.
// If both ends meet in one layer, it belongs to the near end.
//
// Based on: Bavoil, Myers, "Order Independent Transparency with Dual Depth Peeling", 2008 (DUAL); sections
// 3.1 and 3.2 of the paper. Differs in: atomic operations replace blending by maximum, which needs ids that a
// float can hold and mixes the channels of coplanar colours. The forms with lists and arrays therefore take
// one pass per round instead of two, too. Corrected: F2B-2P as printed delivered single fragments twice, and
// started from depths and ids that nothing exceeds.
#include <fmt/format.h>

#include "render/capture/peeling/layer_fold.h"
#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

class DualPeeling final : public Technique {
 public:
  explicit DualPeeling(const LayerFold::Form& form) : form_(form), fold_(form) {}

  [[nodiscard]] bool peels() const override { return true; }
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return fold_.largest_buffer(frame);
  }
  void allocate(Frame& frame) override { fold_.allocate(frame); }
  void start(Frame& /*frame*/, Recorder& recorder) override { fold_.clear(recorder); }

  void peel(Frame& frame, Recorder& recorder, std::uint32_t round) override {
    fold_.begin_round(frame, recorder, round);
    const std::string shader = fmt::format("capture/peeling/peel_ends_{}.frag", fold_.shader_suffix());
    if (form_.storage == LayerStorage::pairs) {
      // The ids of a layer must be known before the colours are taken. The first round has no layers yet.
      if (round > 0) {
        frame.gather(recorder, shader, fold_.constants(frame, 0));
        recorder.barrier();
      }
      frame.gather(recorder, shader, fold_.constants(frame, 1));
    } else {
      frame.gather(recorder, shader, fold_.constants(frame));
    }
    recorder.barrier();
    fold_.fold(frame, recorder);
  }

  [[nodiscard]] std::string_view box_shader() const override {
    return form_.sides == 1 ? "capture/peeling/box_left_1.frag" : "capture/peeling/box_left_2.frag";
  }
  void finish(Frame& frame, Recorder& recorder) override { fold_.finish(frame, recorder); }

 private:
  LayerFold::Form form_;
  LayerFold fold_;
};

template <LayerStorage storage, std::uint32_t sides, bool resumes = true>
std::unique_ptr<Technique> make() {
  return std::make_unique<DualPeeling>(
      LayerFold::Form{.storage = storage, .search = true, .sides = sides, .resumes = resumes});
}

}  // namespace

TechniqueEntry f2b_2p() {
  return {{.name = "f2b-2p",
           .title = "front-to-back peeling, two coplanar fragments a round",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all",
           .passes_formula = "2 sum of ceil(C / 2) + 1",
           .bytes_formula = "104",
           .groups = {OptionGroup::culling}},
          make<LayerStorage::pairs, 1>};
}

TechniqueEntry dual() {
  return {{.name = "dual",
           .title = "dual depth peeling",
           .paper = "Bavoil, Myers 2008",
           .exact = false,
           .captures = "of fragments at one depth one: of the smallest id in front, of the largest behind",
           .passes_formula = "ceil(D / 2) + 1",
           .bytes_formula = "96",
           .groups = {OptionGroup::culling},
           .needs_atomics64 = true},
          make<LayerStorage::chains, 2, false>};
}

TechniqueEntry dual_2p() {
  return {{.name = "dual-2p",
           .title = "dual depth peeling, two coplanar fragments a round at either end",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all",
           .passes_formula = "1 + 1 to 2 times the sum of ceil(C / 2)",
           .bytes_formula = "204",
           .groups = {OptionGroup::culling}},
          make<LayerStorage::pairs, 2>};
}

TechniqueEntry dual_ll() {
  return {{.name = "dual-ll",
           .title = "dual depth peeling, a linked list for every layer",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all that the pool has room for",
           .passes_formula = "ceil(D / 2) + 1",
           .bytes_formula = "12 N + 92",
           .groups = {OptionGroup::pool, OptionGroup::overflow, OptionGroup::culling}},
          make<LayerStorage::lists, 2>};
}

TechniqueEntry dual_kb() {
  return {{.name = "dual-kb",
           .title = "dual depth peeling, k coplanar fragments a round at either end",
           .paper = "Vasilakis, Fudos 2014",
           .captures = "all",
           .passes_formula = "1 + half to all of the sum of ceil(C / K)",
           .bytes_formula = "16 K + 100",
           .groups = {OptionGroup::k, OptionGroup::culling},
           .needs_atomics64 = true},
          make<LayerStorage::chains, 2>};
}

TechniqueEntry dual_fab() {
  return {{.name = "dual-fab",
           .title = "dual depth peeling, an array of k fragments for either layer",
           .paper = "Vasilakis, Fudos 2014",
           .exact = false,
           .order_free = false,
           .captures = "of more than k fragments at one depth, those drawn first",
           .passes_formula = "ceil(D / 2) + 1",
           .bytes_formula = "16 K + 92",
           .groups = {OptionGroup::k, OptionGroup::culling}},
          make<LayerStorage::arrays, 2>};
}

}  // namespace pellucid::render
