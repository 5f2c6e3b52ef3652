// Draws an image: counts fragments, cuts the image into bands where buffers would be too large, captures,
// resolves and reads back.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <new>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "render/capture/automatic.h"
#include "render/capture/registry.h"
#include "render/capture/technique.h"
#include "render/checks.h"
#include "render/frame.h"
#include "render/options.h"
#include "render/resolve/read_back.h"
#include "render/scene/culling.h"
#include "render/scene/opaque_layer.h"

namespace pellucid {
namespace render {
namespace {

OwnedQueryPool make_timestamps(Context& context) {
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = kMostTimestamps};
  VkQueryPool pool = VK_NULL_HANDLE;
  context.call("creating queries",
               [&] { return vkCreateQueryPool(context.device(), &info, nullptr, &pool); });
  return {context.device(), pool};
}

}  // namespace
}  // namespace render

struct Renderer::Implementation {
  explicit Implementation(const DeviceOptions& options)
      : context(options),
        pipelines(context),
        timestamps(render::make_timestamps(context)),
        unused(context, "unused slot", 16),
        left_after(context, "pixels left after rounds", 4 * render::kMostRounds,
                   render::MemoryKind::readback),
        frame_buffer(context, "frame", sizeof(render::FrameData)) {}

  // The arguments of one draw().
  struct Job {
    const Camera& camera;
    const RenderOptions& options;
    const render::TechniqueEntry& technique;
    std::uint32_t effect;
    Progress* progress;
    Sync sync = Sync::automatic;
  };
  struct Band {
    std::uint32_t first_row, rows;
  };

  RenderResult draw(Job job);
  // Throws Error{internal} if the device was lost.
  void refuse_if_lost() const;
  void draw_band(const Job& job, const Band& band, RenderResult& result);
  // The fragments of a band in front of opaque surfaces.
  struct Counted {
    render::Frame frame;
    std::vector<std::uint32_t> counts;  // fragments of every pixel
    CaptureStats opaque, counting;      // time and passes of drawing opaque surfaces and of counting
    bool needed = false;                // the counts are needed, whichever technique draws
  };
  // Captures a band. Returns false, without doing anything, if the band is too large for the technique.
  bool capture_band(const Job& job, const Band& band, Counted& counted, RenderResult& result);
  // Does the same with the technique that `auto` chooses for the counts.
  bool choose_and_capture(const Job& job, const Band& band, Counted& counted, RenderResult& result);
  // Returns the technique that takes over when the pool of the requested technique, or the loops of the
  // driver, do not suffice.
  [[nodiscard]] std::unique_ptr<render::Technique> make_for_small_pool(const Job& job,
                                                                       const render::Frame& frame) const;
  // Captures the band again with that technique, after removing what `result` got of the band since `before`.
  void capture_again(const Job& job, const Band& band, const render::Frame& first, const CaptureStats& before,
                     RenderResult& result, const std::vector<std::uint32_t>& counts);
  render::Frame make_frame(const Job& job, const Band& band);
  // Draws the opaque surfaces if the effect blends. Afterwards only the others remain to be drawn.
  void draw_opaque(const Job& job, const render::Frame& frame, CaptureStats& stats);
  // Counts the fragments of every pixel.
  std::vector<std::uint32_t> count(const Job& job, render::Frame& frame, CaptureStats& stats);
  std::optional<render::Culling> start_culling(const Job& job, const render::Frame& frame,
                                               CaptureStats& stats);
  void capture(const Job& job, render::Frame& frame, render::Technique& technique, RenderResult& result,
               const std::vector<std::uint32_t>& counts);
  // Records commands, submits them and measures their time.
  void run(const Job& job, const render::Frame& frame, CaptureStats& stats,
           const std::function<void(render::Recorder&)>& record);
  void read_times(std::uint32_t count, CaptureStats& stats);
  // Runs all rounds of a technique that peels.
  void peel(const Job& job, render::Frame& frame, render::Technique& technique, CaptureStats& stats);
  // Runs `count` rounds in one submission. Returns the number of rounds after which nothing was left, or
  // count + 1 if something is left.
  std::uint32_t peel_together(const Job& job, render::Frame& frame, render::Technique& technique,
                              std::uint32_t first, std::uint32_t count, const render::Culling* culling,
                              CaptureStats& stats);

  render::Context context;
  render::Pipelines pipelines;
  render::OwnedQueryPool timestamps;
  std::optional<render::GpuScene> scene;
  std::optional<render::OpaqueLayer> opaque;
  render::Buffer unused;      // bound to slots that a shader declares but does not use
  render::Buffer left_after;  // after each round: pixels for which the next round may find something
  render::Buffer frame_buffer, final_colors, dump;
  using BandKey = std::pair<std::uint32_t, std::uint32_t>;
  std::map<BandKey, render::Buffer> residues;             // what the last frame left, by band
  std::map<BandKey, render::DrawOrderHistory> histories;  // of all frames of the scene, by band
  std::set<BandKey> drawn_bands;                          // of the current one
};

render::Frame Renderer::Implementation::make_frame(const Job& job, const Band& band) {
  return {.context = context,
          .pipelines = pipelines,
          .scene = *scene,
          .options = job.options,
          .effect = job.effect,
          .sync = job.sync,
          .width = job.camera.width,
          .height = band.rows * job.options.samples,
          .first_row = band.first_row,
          .image_height = job.camera.height,
          .counters = render::Buffer(context, "counters", sizeof(render::Counters)),
          .residue = &residues[{band.first_row, band.rows}]};
}

void Renderer::Implementation::run(const Job& job, const render::Frame& frame, CaptureStats& stats,
                                   const std::function<void(render::Recorder&)>& record) {
  stop_if_requested(job.progress);
  std::uint32_t timestamps_used = 0;
  context.submit([&](VkCommandBuffer commands) {
    render::Recorder recorder(context, commands, unused, timestamps.get());
    recorder.bind(render::Slot::frame, frame_buffer);
    recorder.bind(render::Slot::triangles, scene->triangles);
    recorder.bind(render::Slot::surfaces, scene->surfaces);
    recorder.bind(render::Slot::indices, scene->indices);
    recorder.bind(render::Slot::positions, scene->positions);
    recorder.bind(render::Slot::objects, scene->objects);
    if (scene->attributes) recorder.bind(render::Slot::attributes, scene->attributes);
    if (scene->textures) recorder.bind(render::Slot::textures, scene->textures);
    recorder.bind(render::Slot::counters, frame.counters);
    recorder.bind(render::Slot::opaque, opaque->nearest());
    if (final_colors) recorder.bind(render::Slot::final_colors, final_colors);
    if (dump) recorder.bind(render::Slot::dump, dump);
    recorder.begin_time();
    record(recorder);
    recorder.end_time();
    timestamps_used = recorder.timestamps();
    stats.geometry_passes += recorder.geometry_passes();
    stats.fullscreen_passes += recorder.fullscreen_passes();
  });
  read_times(timestamps_used, stats);
}

// The timestamps are: the beginning, pairs of beginning and end of a resolve, and the end.
void Renderer::Implementation::read_times(std::uint32_t count, CaptureStats& stats) {
  std::array<std::uint64_t, render::kMostTimestamps> ticks{};
  context.call("reading timestamps", [&] {
    return vkGetQueryPoolResults(context.device(), timestamps.get(), 0, count, sizeof ticks, ticks.data(),
                                 sizeof ticks[0], VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  });
  const double milliseconds_per_tick = context.nanoseconds_per_tick() * 1e-6;
  stats.milliseconds += static_cast<double>(ticks.at(count - 1) - ticks[0]) * milliseconds_per_tick;
  for (std::size_t i = 1; i + 2 < count; i += 2)
    stats.resolve_milliseconds += static_cast<double>(ticks.at(i + 1) - ticks.at(i)) * milliseconds_per_tick;
}

void Renderer::Implementation::draw_opaque(const Job& job, const render::Frame& frame, CaptureStats& stats) {
  const bool needed = render::OpaqueLayer::needed(frame);
  opaque.emplace(frame);
  scene->draw_only(true);
  pipelines.use_features(scene->features());
  const render::FrameData data = render::frame_data(job.camera, frame);
  render::upload<render::FrameData>(context, frame_buffer, std::span(&data, 1));
  run(job, frame, stats, [&](render::Recorder& recorder) {
    recorder.prepare(opaque->nearest());
    if (needed) opaque->draw(frame, recorder);
  });
  if (needed) {
    scene->draw_only(false);
  } else {
    scene->draw_all();
    if (render::cuts_solids(static_cast<Effect>(job.effect))) scene->draw_both_sides();
  }
  pipelines.use_features(scene->features() | (needed ? render::behind_opaque : 0U));
}

std::vector<std::uint32_t> Renderer::Implementation::count(const Job& job, render::Frame& frame,
                                                           CaptureStats& stats) {
  const render::Buffer counts(context, "fragment counts", 4 * frame.pixels());
  const render::FrameData data = render::frame_data(job.camera, frame);
  render::upload<render::FrameData>(context, frame_buffer, std::span(&data, 1));
  run(job, frame, stats, [&](render::Recorder& recorder) {
    recorder.bind(render::Slot::a, counts);
    recorder.fill(counts, 0);
    recorder.barrier();
    frame.gather(recorder, "capture/count.frag", {});
  });
  std::vector<std::uint32_t> values(frame.pixels());
  counts.download(context, std::as_writable_bytes(std::span(values)));
  frame.fragments = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
  frame.deepest = *std::max_element(values.begin(), values.end());
  frame.counts = values;
  frame.covered = static_cast<std::uint64_t>(
      std::count_if(values.begin(), values.end(), [](std::uint32_t n) { return n > 0; }));
  const std::uint32_t samples = frame.options.samples;
  for (std::uint64_t p = 0; p < frame.pixels() / samples; ++p) {
    bool seen = false;
    for (std::uint32_t s = 0; s < samples; ++s) seen = seen || values[frame.sample_at(p, s)] > 0;
    frame.seen += seen ? 1U : 0U;
  }
  return values;
}

std::optional<render::Culling> Renderer::Implementation::start_culling(const Job& job,
                                                                       const render::Frame& frame,
                                                                       CaptureStats& stats) {
  if (!job.options.peeling.cull || frame.scene.groups.empty()) return std::nullopt;
  std::optional<render::Culling> culling(std::in_place, frame);
  run(job, frame, stats, [&](render::Recorder& recorder) { culling->start(recorder); });
  return culling;
}

std::uint32_t Renderer::Implementation::peel_together(const Job& job, render::Frame& frame,
                                                      render::Technique& technique, std::uint32_t first,
                                                      std::uint32_t count, const render::Culling* culling,
                                                      CaptureStats& stats) {
  const bool known = technique.known_rounds() > 0;
  CaptureStats recorded;  // includes the passes of rounds that are skipped
  std::array<std::array<std::uint32_t, 2>, render::kMostRounds + 1> passes{};  // before each round
  run(job, frame, recorded, [&](render::Recorder& recorder) {
    for (std::uint32_t i = 0; i < count; ++i) {
      recorder.barrier();
      const bool conditional = i > 0 && !known;
      if (conditional) recorder.begin_if(left_after, i - 1);
      if (culling != nullptr) recorder.draw_groups(culling->groups(), culling->predicates());
      technique.peel(frame, recorder, first + i);
      if (culling != nullptr) {
        recorder.barrier();
        culling->test(frame, recorder, technique.box_shader());
      }
      recorder.end_resolve();
      if (conditional) recorder.end_if();
      recorder.copy_word(frame.counters, offsetof(render::Counters, active_pixels), left_after, 4 * i);
      passes.at(i + 1) = {recorder.geometry_passes(), recorder.fullscreen_passes()};
    }
    recorder.barrier_to_host();
  });
  std::array<std::uint32_t, render::kMostRounds> left{};
  left_after.download(context, std::as_writable_bytes(std::span(left)));
  const auto* const none = std::find(left.begin(), left.begin() + count, 0U);
  const std::uint32_t used = known ? count + 1 : static_cast<std::uint32_t>(none - left.begin()) + 1;
  stats.geometry_passes += passes.at(std::min(used, count))[0];
  stats.fullscreen_passes += passes.at(std::min(used, count))[1];
  stats.milliseconds += recorded.milliseconds;
  stats.resolve_milliseconds += recorded.resolve_milliseconds;
  return used;
}

void Renderer::Implementation::peel(const Job& job, render::Frame& frame, render::Technique& technique,
                                    CaptureStats& stats) {
  const std::optional<render::Culling> culling = start_culling(job, frame, stats);
  const render::Culling* groups = culling ? &*culling : nullptr;
  // If the number of rounds is not known, there is at most one per depth layer and pair of coplanar
  // fragments, and a last one that finds nothing.
  const bool known = technique.known_rounds() > 0;
  const std::uint64_t most = known ? technique.known_rounds() : frame.deepest + 2;
  const bool together = !culling && (known || context.info().conditional);
  std::uint64_t drawn = 0;
  std::uint32_t round = 0;
  while (round < most) {
    if (culling) drawn += culling->triangles_left(context);
    const auto count =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(together ? render::kMostRounds : 1, most - round));
    const std::uint32_t used = peel_together(job, frame, technique, round, count, groups, stats);
    round += std::min(used, count);
    if (!known && used <= count) break;
  }
  stats.rounds += round;
  run(job, frame, stats, [&](render::Recorder& recorder) { technique.finish(frame, recorder); });
  if (culling) {
    const std::uint64_t all = culling->triangles() * round;
    stats.drawn_share = all == 0 ? 1 : static_cast<double>(drawn) / static_cast<double>(all);
  }
}

void Renderer::Implementation::capture(const Job& job, render::Frame& frame, render::Technique& technique,
                                       RenderResult& result, const std::vector<std::uint32_t>& counts) {
  CaptureStats& stats = result.stats;
  const render::FrameData data = render::frame_data(job.camera, frame);
  render::upload<render::FrameData>(context, frame_buffer, std::span(&data, 1));
  final_colors = render::Buffer(context, "image", 16 * frame.pixels());
  std::vector<std::uint32_t> offsets;
  if (job.effect == render::kDumpEffect) {
    offsets.reserve(counts.size() + 1);
    offsets.push_back(0);
    for (const std::uint32_t n : counts) offsets.push_back(offsets.back() + n);
    std::vector<std::uint32_t> words = offsets;
    words.resize(offsets.size() + render::kDumpWords * frame.fragments, 0);
    dump = render::Buffer(context, "fragments", 4 * words.size());
    render::upload<std::uint32_t>(context, dump, words);
  }
  technique.allocate(frame);
  run(job, frame, stats, [&](render::Recorder& recorder) {
    recorder.fill(frame.counters, 0);
    technique.start(frame, recorder);
  });
  technique.allocate_rounds(frame);
  if (technique.peels()) peel(job, frame, technique, stats);
  stats.bytes = std::max(stats.bytes, frame.technique_bytes);
  render::Counters counters{};
  frame.counters.download(context, std::as_writable_bytes(std::span(&counters, 1)));
  stats.fragments += frame.fragments;
  // Hardware blending takes every fragment and counts none.
  if (job.options.statistics) {
    stats.captured += job.technique.info.blends_only ? frame.fragments : counters.captured;
    stats.coplanar += counters.coplanar;
    stats.coplanar_pixels += counters.coplanar_pixels;
  }
  if (job.technique.info.blends_only && job.technique.info.exact) stats.repaired_pixels += counters.covered;
  stats.misordered_pixels += counters.misordered_pixels;
  stats.overflowed += counters.overflowed;
  stats.deepest_pixel = std::max<std::uint64_t>(stats.deepest_pixel, frame.deepest);
  stats.covered_pixels += frame.covered;
  stats.seen_pixels += frame.seen;
  technique.report(frame, counts, result);
  if (job.effect == render::kDumpEffect) {
    // Techniques with a tail deliver ids in the place of colours.
    render::read_fragments(dump, frame, offsets, !job.technique.info.keeps_tail, result);
  } else {
    render::read_colors(final_colors, frame, result);
  }
}

void Renderer::Implementation::draw_band(const Job& job, const Band& band, RenderResult& result) {
  // Kernels run over lists of tiles with one workgroup per tile. This is the number that every device can
  // dispatch in one dimension.
  constexpr std::uint64_t kMostTiles = 65'535;
  const std::uint64_t most = context.info().max_buffer_bytes;
  const auto halves = [&] {
    const std::uint32_t upper = band.rows / 2;
    draw_band(job, {band.first_row, upper}, result);
    draw_band(job, {band.first_row + upper, band.rows - upper}, result);
  };
  Counted counted{make_frame(job, band), {}, {}, {}};
  render::Frame& frame = counted.frame;
  const bool too_large =
      32 * frame.pixels() > most || frame.tiles() > kMostTiles || frame.height > context.info().max_side;
  if (band.rows > 1 && too_large) return halves();
  draw_opaque(job, frame, counted.opaque);
  counted.counts = count(job, frame, counted.counting);
  frame.counts = counted.counts;
  const bool is_chosen = job.technique.make == nullptr;
  if (!(is_chosen ? choose_and_capture(job, band, counted, result)
                  : capture_band(job, band, counted, result)))
    halves();
}

bool Renderer::Implementation::choose_and_capture(const Job& job, const Band& band, Counted& counted,
                                                  RenderResult& result) {
  render::DrawOrderHistory& history = histories[{band.first_row, band.rows}];
  const render::AutomaticDemand demand = render::automatic_demand(counted.frame, history);
  const render::AutomaticChoice choice = render::choose_technique(demand);
  RenderOptions named = job.options;
  named.technique = choice.technique;
  Job chosen{job.camera, job.options, render::find_technique(named, context.info()), job.effect,
             job.progress};
  render::check_technique(chosen.technique.info, job.options, context.info());
  chosen.sync = render::choose_sync(chosen.technique.info, job.options, context.info());
  counted.frame.sync = chosen.sync;
  // With a memory budget, the counts of this frame decide. Without one, the counts of the last frame would
  // suffice.
  counted.needed = job.options.budget.bytes != 0;
  const CaptureStats before = result.stats;
  result.stats.pool_exceeded = false;
  if (!capture_band(chosen, band, counted, result)) {
    result.stats = before;
    return false;
  }
  if (job.effect != render::kDumpEffect)
    history.add_frame(choice.technique, render::repairs_between(before, result.stats, demand));
  result.stats.pool_exceeded = result.stats.pool_exceeded || before.pool_exceeded;
  result.stats.sync = chosen.sync;
  if (result.stats.chosen.find(choice.technique) == std::string::npos) {
    result.stats.chosen.append(result.stats.chosen.empty() ? "" : ", ").append(choice.technique);
    result.stats.reason.append(result.stats.reason.empty() ? "" : "; ").append(choice.reason);
  }
  return true;
}

bool Renderer::Implementation::capture_band(const Job& job, const Band& band, Counted& counted,
                                            RenderResult& result) {
  render::Frame& frame = counted.frame;
  const bool pool_exceeded = job.technique.info.pooled && frame.fragments > frame.capacity();
  std::unique_ptr<render::Technique> technique =
      pool_exceeded ? make_for_small_pool(job, frame) : job.technique.make();
  const std::uint64_t needed = std::max(technique->largest_buffer(frame),
                                        job.effect == render::kDumpEffect
                                            ? 4 * (frame.pixels() + 1 + render::kDumpWords * frame.fragments)
                                            : 0);
  const bool over_budget =
      job.options.budget.bytes != 0 && technique->least_bytes(frame) > job.options.budget.bytes;
  if (band.rows > 1 && (needed > context.info().max_buffer_bytes || over_budget)) return false;
  if (over_budget) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("memory budget: {} bytes do not hold what is kept of a row of pixels: {} bytes",
                            job.options.budget.bytes, technique->least_bytes(frame)));
  }
  drawn_bands.insert({band.first_row, band.rows});
  result.stats.pool_exceeded = result.stats.pool_exceeded || pool_exceeded;
  result.stats.milliseconds += counted.opaque.milliseconds;
  result.stats.geometry_passes += counted.opaque.geometry_passes;
  if (counted.needed || technique->needs_counts(frame)) {
    result.stats.milliseconds += counted.counting.milliseconds;
    result.stats.geometry_passes += counted.counting.geometry_passes;
  }
  const CaptureStats before_capture = result.stats;
  capture(job, frame, *technique, result, counted.counts);
  // Layers that share a pool one after the other may be larger than the pool, and a driver may end loops
  // early. What is lost then would depend on the draw order, so the band is captured again.
  const bool lost = !pool_exceeded && result.stats.overflowed > before_capture.overflowed;
  if (!lost || !job.technique.info.exact || !context.info().atomics64) return true;
  technique.reset();
  capture_again(job, band, frame, before_capture, result, counted.counts);
  return true;
}

void Renderer::Implementation::capture_again(const Job& job, const Band& band, const render::Frame& first,
                                             const CaptureStats& before, RenderResult& result,
                                             const std::vector<std::uint32_t>& counts) {
  const CaptureStats wasted = std::exchange(result.stats, before);
  result.stats.milliseconds = wasted.milliseconds;
  result.stats.geometry_passes = wasted.geometry_passes;
  result.stats.pool_exceeded = true;
  const std::size_t pixels = std::size_t{job.camera.width} * band.first_row;
  result.pixels.resize(std::min(result.pixels.size(), pixels));
  std::vector<std::uint64_t>& offsets = result.fragments.offsets;
  offsets.resize(offsets.empty() ? 0 : pixels * job.options.samples + 1);
  result.fragments.fragments.resize(offsets.empty() ? 0 : offsets.back());
  result.fragments.colors.resize(result.fragments.fragments.size());
  render::Frame frame = make_frame(job, band);
  frame.fragments = first.fragments;
  frame.deepest = first.deepest;
  frame.covered = first.covered;
  frame.seen = first.seen;
  frame.counts = first.counts;
  capture(job, frame, *make_for_small_pool(job, frame), result, counts);
}

std::unique_ptr<render::Technique> Renderer::Implementation::make_for_small_pool(
    const Job& job, const render::Frame& frame) const {
  if (!context.info().atomics64) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("the pool has {} nodes for {} fragments, and what is done then needs 64-bit "
                            "atomics, which {} does not support",
                            frame.capacity(), frame.fragments, context.info().name));
  }
  const bool suffices = frame.fragments <= frame.capacity();
  return render::nearest_rounds_in_pool(suffices ? Overflow::exact : job.options.pool.overflow);
}

RenderResult Renderer::Implementation::draw(Job job) {
  // Releases everything that belongs to this draw, also when an error is thrown.
  struct Release {
    Implementation& self;
    bool finished = false;
    ~Release() {
      // A residue is not valid if its frame was not finished. The residues of other bands belong to an image
      // of another size.
      if (!finished) self.residues.clear();
      const auto of_another_image = [&](const auto& entry) {
        return !self.drawn_bands.contains(entry.first);
      };
      std::erase_if(self.residues, of_another_image);
      std::erase_if(self.histories, of_another_image);
      self.drawn_bands.clear();
      self.opaque.reset();
      self.final_colors = {};
      self.dump = {};
    }
  } release{*this};
  RenderResult result;
  result.stats.sync = job.sync;
  result.width = job.camera.width;
  result.height = job.camera.height;
  draw_band(job, {0, job.camera.height}, result);
  if (job.options.keep_fragments) {
    job.effect = render::kDumpEffect;
    RenderResult dumped;
    draw_band(job, {0, job.camera.height}, dumped);
    result.fragments = std::move(dumped.fragments);
  }
  release.finished = true;
  return result;
}

void Renderer::Implementation::refuse_if_lost() const {
  if (context.lost())
    throw Error(ErrorKind::internal, "the device was lost; make a new Renderer to continue");
}

Renderer::Renderer(const DeviceOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const DeviceInfo& Renderer::info() const {
  return implementation_->context.info();
}

void Renderer::load(const RenderScene& scene) {
  implementation_->refuse_if_lost();
  implementation_->scene.reset();
  implementation_->residues.clear();
  implementation_->histories.clear();
  implementation_->scene = render::upload_scene(implementation_->context, scene);
}

std::vector<std::string> Renderer::validation_messages() const {
  return implementation_->context.validation_messages();
}

RenderResult Renderer::draw(const Camera& camera, const RenderOptions& options, Progress* progress) {
  Implementation& self = *implementation_;
  self.refuse_if_lost();
  if (!self.scene) throw Error(ErrorKind::bad_argument, "nothing was loaded that could be drawn");
  render::check_options(camera, options, info(), self.scene->object_count);
  const render::TechniqueEntry& technique = render::find_technique(options, info());
  RenderOptions own;
  const bool is_chosen = technique.make == nullptr;
  if (is_chosen) own = render::automatic_options(options);
  const RenderOptions& used = is_chosen ? own : options;
  Implementation::Job job{camera, used, technique, static_cast<std::uint32_t>(options.effect), progress};
  render::check_technique(technique.info, used, info());
  job.sync = render::choose_sync(technique.info, used, info());
  try {
    return self.draw(job);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::internal,
                fmt::format("out of memory while drawing {}x{} pixels by {}: try a smaller image",
                            camera.width, camera.height, options.technique));
  }
}

OverdrawCount Renderer::count_overdraw(const Camera& camera) {
  Implementation& self = *implementation_;
  self.refuse_if_lost();
  if (!self.scene) throw Error(ErrorKind::bad_argument, "nothing was loaded that could be drawn");
  // With this effect, opaque surfaces are drawn like all others.
  RenderOptions options;
  options.effect = Effect::complexity;
  render::check_options(camera, options, info(), self.scene->object_count);
  const Implementation::Job job{camera, options, render::find_technique(options, info()),
                                static_cast<std::uint32_t>(options.effect), nullptr};
  render::Frame frame = self.make_frame(job, {0, camera.height});
  CaptureStats ignored;
  self.draw_opaque(job, frame, ignored);
  const std::vector<std::uint32_t> counts = self.count(job, frame, ignored);
  const render::Image depth = frame.make_image("depth", VK_FORMAT_D32_SFLOAT);
  self.run(job, frame, ignored, [&](render::Recorder& recorder) {
    recorder.fill(frame.counters, 0);
    recorder.prepare(depth);
    recorder.barrier();
    render::Attachments attachments = frame.attachments();
    attachments.depth = &depth;
    recorder.draw(frame.scene,
                  frame.pipelines.scene({.fragment_shader = "scene/shaded.frag",
                                         .depth = VK_FORMAT_D32_SFLOAT,
                                         .depth_test = render::DepthTest::less,
                                         .depth_write = true}),
                  attachments);
  });
  render::Counters counters{};
  frame.counters.download(self.context, std::as_writable_bytes(std::span(&counters, 1)));
  self.opaque.reset();
  const auto covered = std::count_if(counts.begin(), counts.end(), [](std::uint32_t n) { return n > 0; });
  return {counters.captured, static_cast<std::uint64_t>(covered)};
}

}  // namespace pellucid
