// Implements culling.h: boxes of groups of triangles, and the queries that cull them.
#include "render/scene/culling.h"

#include <array>

namespace pellucid::render {
namespace {

// The triangles of a box are wound the wrong way round, so that culling of back faces leaves the far sides.
constexpr std::array<std::uint32_t, 36> kFarSides{0, 3, 2, 0, 1, 3, 4, 7, 5, 4, 6, 7, 0, 6, 4, 0, 2, 6,
                                                  1, 7, 3, 1, 5, 7, 0, 5, 1, 0, 4, 5, 2, 7, 6, 2, 3, 7};

OwnedQueryPool make_queries(Context& context, std::size_t count) {
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .queryType = VK_QUERY_TYPE_OCCLUSION,
                                   .queryCount = static_cast<std::uint32_t>(count)};
  VkQueryPool pool = VK_NULL_HANDLE;
  context.call("creating queries",
               [&] { return vkCreateQueryPool(context.device(), &info, nullptr, &pool); });
  return {context.device(), pool};
}

}  // namespace

Culling::Culling(const Frame& frame) {
  std::vector<std::array<Vec3f, 2>> bounds;
  for (const TriangleGroup& group : frame.scene.groups) {
    groups_.push_back(group.range);
    bounds.push_back({group.low, group.high});
  }
  std::vector<Vec3f> corners;
  for (const auto& box : bounds) {
    for (std::size_t c = 0; c < 8; ++c) {
      corners.push_back({box.at(c & 1U).x, box.at((c >> 1U) & 1U).y, box.at((c >> 2U) & 1U).z});
    }
  }
  Context& context = frame.context;
  corners_ = make_filled(context, "boxes", corners);
  bounds_ = make_filled(context, "bounds of boxes", bounds);
  indices_ =
      make_filled(context, "sides of a box", std::vector<std::uint32_t>(kFarSides.begin(), kFarSides.end()));
  predicates_ = Buffer(context, "results of queries", 4 * groups_.size());
  queries_ = make_queries(context, groups_.size());
}

std::uint64_t Culling::triangles() const {
  std::uint64_t sum = 0;
  for (const DrawRange& group : groups_) sum += group.triangles;
  return sum;
}

void Culling::start(Recorder& recorder) const {
  recorder.fill(predicates_, 1);
}

void Culling::test(const Frame& frame, Recorder& recorder, std::string_view shader) const {
  recorder.bind(Slot::e, bounds_);
  recorder.draw_boxes({.corners = corners_,
                       .indices = indices_,
                       .index_count = static_cast<std::uint32_t>(kFarSides.size()),
                       .predicates = predicates_,
                       .queries = queries_.get(),
                       .count = static_cast<std::uint32_t>(groups_.size())},
                      frame.pipelines.scene({.fragment_shader = shader, .clamp_depth = true}),
                      frame.attachments());
}

std::uint64_t Culling::triangles_left(Context& context) const {
  std::vector<std::uint32_t> samples(groups_.size());
  predicates_.download(context, std::as_writable_bytes(std::span(samples)));
  std::uint64_t triangles = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) triangles += samples[g] > 0 ? groups_[g].triangles : 0;
  return triangles;
}

}  // namespace pellucid::render
