// Sums in place of an order: see color_sums.h.
#include "render/capture/color_sums.h"

namespace pellucid::render {

void draw_sums(const Frame& frame, Recorder& recorder, std::string_view fragment_shader,
               const Constants& constants, const std::vector<const Image*>& targets) {
  std::vector<VkFormat> formats;
  for (const Image* target : targets) {
    recorder.prepare(*target);
    formats.push_back(target->spec().format);
  }
  Attachments attachments = frame.attachments();
  attachments.colors = targets;
  recorder.draw(frame.scene,
                frame.pipelines.scene({.fragment_shader = fragment_shader,
                                       .constants = constants,
                                       .colors = formats,
                                       .blend = Blend::add}),
                attachments);
  recorder.barrier();
}

void resolve_sums(const Frame& frame, Recorder& recorder, const Image& colors, const Image& depths) {
  recorder.begin_resolve();
  recorder.bind(Slot::image_0, colors);
  recorder.bind(Slot::image_1, depths);
  recorder.dispatch(frame.pipelines.compute("resolve/sums.comp", {}), frame.tiles_x(), frame.tiles_y());
}

}  // namespace pellucid::render
