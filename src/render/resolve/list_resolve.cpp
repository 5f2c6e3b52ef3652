// Implements list_resolve.h: sorts and folds lists by classes of tiles.
#include "render/resolve/list_resolve.h"

#include <array>

namespace pellucid::render {
namespace {

// The classes of tiles, as in shaders/resolve/tiles.glsl.
struct TileClass {
  const char* kernel;
  std::uint64_t more_than;  // fragments in the longest list of the tile
};
constexpr std::array<TileClass, 5> kClasses{{{"4", 0}, {"8", 4}, {"16", 8}, {"runs", 16}, {"long", 128}}};

}  // namespace

std::uint64_t ListResolve::bytes(const Frame& frame) {
  return 4 * kClasses.size() * (3 + frame.tiles());
}

bool ListResolve::ends_early(const Frame& frame) {
  // This counts turns as fold_bucket() of shaders/resolve/lists.comp does for LONG lists.
  constexpr std::uint64_t kRoom = 32;
  const std::uint64_t count = frame.deepest;
  if (count <= kClasses.back().more_than) return false;
  const std::uint64_t rounds = (count + kRoom - 1) / kRoom;
  return 2 * count + rounds * (count + 2 * kRoom) > loop_budget(frame.context.info());
}

void ListResolve::allocate(Frame& frame) {
  tiles_ = frame.make_buffer("list of tiles", bytes(frame));
}

void ListResolve::record(Frame& frame, Recorder& recorder, std::uint32_t k,
                         const Buffer* marked_tiles) const {
  recorder.begin_resolve();
  const Constants constants{frame.effect, k,
                            (frame.options.statistics ? 0U : 1U) | (marked_tiles != nullptr ? 2U : 0U)};
  recorder.bind(Slot::e, tiles_);
  recorder.dispatch(frame.pipelines.compute("resolve/clear_tiles.comp", {}), 1, 1);
  recorder.barrier();
  const OwnedPipeline& classify =
      frame.pipelines.compute("resolve/classify_" + storage_ + ".comp", constants);
  if (marked_tiles != nullptr) {
    recorder.dispatch_indirect(classify, *marked_tiles, 0);
  } else {
    recorder.dispatch(classify, frame.tiles_x(), frame.tiles_y());
  }
  recorder.barrier();
  recorder.push().p[0] = loop_budget(frame.context.info());
  for (std::uint32_t i = 0; i < kClasses.size(); ++i) {
    // Kernels of classes that no pixel of the frame needs are not even compiled.
    if (i > 0 && frame.deepest <= kClasses.at(i).more_than) break;
    recorder.push().p[1] = i;
    const std::string kernel = frame.options.plain_resolve ? "plain" : kClasses.at(i).kernel;
    recorder.dispatch_indirect(
        frame.pipelines.compute("resolve/lists_" + storage_ + "_" + kernel + ".comp", constants), tiles_,
        12 * std::uint64_t{i});
    recorder.barrier();
  }
  recorder.count_fullscreen_pass();  // one pass in all, because every tile is in one class
}

}  // namespace pellucid::render
