// Implements layer_fold.h: storage of layers, and the kernels that fold them.
#include "render/capture/peeling/layer_fold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace pellucid::render {
namespace {

std::string name_of(LayerStorage storage) {
  switch (storage) {
    case LayerStorage::image:
      return "image";
    case LayerStorage::pairs:
      return "pairs";
    case LayerStorage::lists:
      return "lists";
    case LayerStorage::arrays:
      return "arrays";
    case LayerStorage::chains:
      return "chains";
  }
  return "";
}

}  // namespace

std::uint64_t LayerFold::storage_bytes(const Frame& frame) const {
  const std::uint64_t ends = form_.sides * frame.pixels();
  switch (form_.storage) {
    case LayerStorage::image:
      return 0;
    case LayerStorage::pairs:
      return 20 * ends;
    case LayerStorage::lists:
      return 12 * frame.capacity();
    case LayerStorage::arrays:
    case LayerStorage::chains:
      return 8 * constants(frame).at(1) * ends;
  }
  return 0;
}

std::uint64_t LayerFold::largest_buffer(const Frame& frame) const {
  return std::max(storage_bytes(frame), kStateBytes * frame.pixels());
}

void LayerFold::allocate(Frame& frame) {
  const std::uint64_t ends = form_.sides * frame.pixels();
  const bool resumes =
      form_.storage == LayerStorage::pairs || (form_.storage == LayerStorage::chains && form_.resumes);
  const bool counted = form_.storage == LayerStorage::lists || form_.storage == LayerStorage::arrays;
  const auto make = [&](Buffer& buffer, const char* name, std::uint64_t bytes) {
    if (bytes > 0) buffer = frame.make_buffer(name, bytes);
  };
  make(depths_, "depths of layers", form_.search ? 8 * ends : 0);
  make(heads_, resumes ? "ids that were peeled" : "heads of layers",
       resumes   ? 8 * ends
       : counted ? 4 * ends
                 : 0);
  make(nodes_, "fragments of layers", storage_bytes(frame));
  // If only one fragment of a layer is delivered, no fragment is coplanar with another one.
  make(coplanar_, "coplanar fragments", resumes || counted ? 4 * frame.pixels() : 0);
  const bool pairs = form_.storage == LayerStorage::pairs;
  make(front_, "states", kStateBytes * frame.pixels());
  make(front_group_, "states of layers", pairs ? kStateBytes * frame.pixels() : 0);
  make(back_, "states from behind", form_.sides > 1 ? kStateBytes * frame.pixels() : 0);
  make(back_group_, "states of layers from behind",
       pairs && form_.sides > 1 ? kStateBytes * frame.pixels() : 0);
}

void LayerFold::clear(Recorder& recorder) const {
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  if (depths_) recorder.fill(depths_, 0);
  if (heads_) recorder.fill(heads_, form_.storage == LayerStorage::lists ? kNone : 0);
  // Lists and arrays need no clearing, because only nodes that were written are read.
  if (form_.storage == LayerStorage::pairs) recorder.fill(nodes_, 0);
  if (form_.storage == LayerStorage::chains) recorder.fill(nodes_, kNone);
  if (coplanar_) recorder.fill(coplanar_, 0);
}

void LayerFold::bind(Recorder& recorder) const {
  const auto bind = [&](Slot slot, const Buffer& buffer) {
    if (buffer) recorder.bind(slot, buffer);
  };
  bind(Slot::a, depths_);
  bind(Slot::b, heads_);
  bind(Slot::c, nodes_);
  bind(Slot::d, coplanar_);
  bind(Slot::state_front, front_);
  bind(Slot::state_group, front_group_);
  bind(Slot::state_back, back_);
  bind(Slot::state_back_group, back_group_);
}

void LayerFold::begin_round(Frame& frame, Recorder& recorder, std::uint32_t round) const {
  bind(recorder);
  recorder.push().round = round;
  recorder.push().p[0] = loop_budget(frame.context.info());
  recorder.fill(frame.counters, 0, offsetof(Counters, active_pixels), sizeof(std::uint32_t));
  // Nodes are used only in the round that fills them, so every round starts with an empty pool.
  recorder.fill(frame.counters, 0, offsetof(Counters, next_node), sizeof(std::uint32_t));
  recorder.barrier();
}

Constants LayerFold::constants(const Frame& frame, std::uint32_t pass) const {
  // Without `resumes`, a chain keeps only one fragment of a layer.
  if (form_.storage == LayerStorage::chains) {
    return {frame.effect, form_.resumes ? frame.options.k : 1, form_.resumes ? 1U : 0U};
  }
  return {frame.effect, frame.options.k, pass};
}

std::string LayerFold::shader_suffix() const {
  const std::string storage = name_of(form_.storage);
  return form_.search ? fmt::format("{}_{}", storage, form_.sides) : storage;
}

void LayerFold::fold(Frame& frame, Recorder& recorder) const {
  recorder.begin_resolve();
  recorder.dispatch(
      frame.pipelines.compute(fmt::format("capture/peeling/fold_layers_{}.comp", shader_suffix()),
                              constants(frame)),
      frame.tiles_x(), frame.tiles_y());
}

void LayerFold::finish(Frame& frame, Recorder& recorder) const {
  recorder.begin_resolve();
  bind(recorder);
  recorder.dispatch(frame.pipelines.compute(fmt::format("capture/peeling/finish_layers_{}.comp", form_.sides),
                                            {frame.effect}),
                    frame.tiles_x(), frame.tiles_y());
}

}  // namespace pellucid::render
