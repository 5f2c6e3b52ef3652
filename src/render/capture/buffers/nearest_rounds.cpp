// Captures fragments in rounds, in a pool that may be too small for all of them at once (MultiKB). With
// Overflow::nearest there is only one round, and the fragments that do not fit are averaged.
//
// A round takes the nearest fragments of each pixel that lie behind the last key (depth, id) of the round
// before. It takes as many as the share of the pixel in the pool has places. All fragments have been counted
// before, so the number of rounds is known. Keys go through a chain of 64-bit atomic minima, and a second
// pass over the fragments stores their colours. Unlike the k-buffer of Bavoil et al. (I3D 2007), the chain
// needs no order of the fragments. Unlike that of Liu et al. (HPG 2009), it needs no second try.
#include <algorithm>
#include <bit>
#include <span>
#include <vector>

#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

struct PoolShares {
  // The first place of each pixel, row by row, and the end. A pixel without fragments has no places.
  std::vector<std::uint32_t> firsts;
  std::uint32_t rounds = 0;  // until all fragments of every pixel with a share have been captured
};

// Returns the histogram of depth complexity: entry n is the number of pixels with n fragments.
std::vector<std::uint64_t> histogram_of(std::span<const std::uint32_t> counts) {
  const std::uint32_t deepest = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  std::vector<std::uint64_t> pixels(std::size_t{deepest} + 1);
  for (const std::uint32_t count : counts) ++pixels[count];
  return pixels;
}

// Returns the largest k for which the sum of min(count, k) does not exceed `places`, but no more than the
// largest count.
std::uint32_t water_level(std::span<const std::uint32_t> counts, std::uint64_t places) {
  const std::vector<std::uint64_t> pixels = histogram_of(counts);
  std::uint64_t taken = 0;
  std::uint64_t deeper = counts.size();  // pixels with more than `level` fragments
  for (std::uint32_t level = 0; level + 1 < pixels.size(); ++level) {
    deeper -= pixels[level];
    if (taken + deeper > places) return level;
    taken += deeper;
  }
  return static_cast<std::uint32_t>(pixels.size() - 1);
}

constexpr std::uint32_t part(std::uint32_t count, std::uint32_t parts) {
  return count / parts + (count % parts != 0 ? 1 : 0);
}

// Returns the least number of rounds, but at least `least`, for which one part of the fragments of every
// pixel fits. More rounds never need more places.
std::uint32_t fewest_rounds(std::span<const std::uint32_t> counts, std::uint64_t places,
                            std::uint32_t least) {
  const std::vector<std::uint64_t> pixels = histogram_of(counts);
  const auto fits = [&](std::uint32_t rounds) {
    std::uint64_t sum = 0;
    for (std::uint32_t n = 1; n < pixels.size(); ++n) sum += pixels[n] * part(n, rounds);
    return sum <= places;
  };
  std::uint32_t low = std::max(least, 1U);
  std::uint32_t high = std::max(low, static_cast<std::uint32_t>(pixels.size() - 1));
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (fits(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

// Makes the shares of all pixels. `share_of` returns the places of a pixel from its number of fragments.
template <class ShareOf>
PoolShares make_shares(std::span<const std::uint32_t> counts, const ShareOf& share_of) {
  PoolShares shares;
  shares.firsts.reserve(counts.size() + 1);
  shares.firsts.push_back(0);
  for (const std::uint32_t count : counts) {
    const std::uint32_t share = share_of(count);
    shares.firsts.push_back(shares.firsts.back() + share);
    if (share > 0) shares.rounds = std::max(shares.rounds, part(count, share));
  }
  return shares;
}

// Gives min(count, k) places to each pixel, for rounds that capture everything. Ignores whether they fit:
// shares that do not fit are handled in several windows.
PoolShares shares_of_k(std::span<const std::uint32_t> counts, std::uint32_t k) {
  return make_shares(counts, [&](std::uint32_t count) { return std::min(count, k); });
}

// Gives each pixel ceil(count / r) places, for the least number of rounds r with which all of them fit into
// `places` and no pixel gets more than `most`. Every pixel with fragments gets at least one place, even if
// they do not fit.
PoolShares divide_for_rounds(std::span<const std::uint32_t> counts, std::uint64_t places,
                             std::uint32_t most) {
  const std::uint32_t deepest = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  const std::uint32_t rounds = fewest_rounds(counts, places, part(deepest, most));
  return make_shares(counts, [&](std::uint32_t count) { return part(count, rounds); });
}

// Gives min(count, k) places to each pixel, for a single round, where k is the largest number with which they
// fit. The places that are left go to deeper pixels at even distances, one each.
PoolShares divide_once(std::span<const std::uint32_t> counts, std::uint64_t places) {
  const std::uint32_t level = water_level(counts, places);
  std::uint64_t taken = 0;
  std::uint64_t deeper = 0;
  for (const std::uint32_t count : counts) {
    taken += std::min(count, level);
    deeper += count > level ? 1U : 0U;
  }
  const std::uint64_t left = std::min(places - taken, deeper);
  std::uint64_t seen = 0;
  return make_shares(counts, [&](std::uint32_t count) {
    if (count <= level) return count;
    const std::uint64_t n = seen++;
    return level + ((n + 1) * left / deeper > n * left / deeper ? 1 : 0);
  });
}

constexpr std::uint64_t kPlaceBytes = 12;                // key and colour
constexpr std::uint64_t kPixelBytes = kStateBytes + 12;  // last key and first place
// Buffers have at least 16 bytes, which is four places.
constexpr std::uint64_t kLeastPoolBytes = 4 * kPlaceBytes;
constexpr std::uint64_t kTailBytes = 20;  // of a pixel: shaders/capture/buffers/overflow_tail.glsl
// The cost of an insertion grows with the number of places. For longer shares another round is cheaper.
constexpr std::uint32_t kMostPlaces = 64;

// The budget per pixel of `bounded` if none is given.
constexpr std::uint64_t kBoundedBytes = 64;

// What decides the number of places: RenderOptions::k unless there is a memory budget, the memory budget or
// kBoundedBytes, or the pool.
enum class Budget { k, memory, pool };

class NearestRounds final : public Technique {
 public:
  NearestRounds(Budget budget, Overflow overflow) : budget_(budget), overflow_(overflow) {}

  [[nodiscard]] bool needs_counts(const Frame& /*frame*/) const override { return true; }
  [[nodiscard]] std::uint64_t least_bytes(const Frame& frame) const override {
    return budget_ == Budget::pool ? 0 : kPixelBytes * frame.pixels() + 4 + kLeastPoolBytes;
  }
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    const std::uint64_t keys = 8 * std::min(places(frame), frame.fragments);
    return std::max(keys, kStateBytes * frame.pixels());
  }

  void allocate(Frame& frame) override {
    const std::uint64_t allowed = places(frame);
    const PoolShares shares = loses()          ? divide_once(frame.counts, allowed)
                              : given_k(frame) ? shares_of_k(frame.counts, frame.options.k)
                                               : divide_for_rounds(frame.counts, allowed, kMostPlaces);
    const std::uint64_t needed = shares.firsts.back();
    window_ = static_cast<std::uint32_t>(std::min(allowed, needed));
    windows_ = window_ == 0 ? 1 : static_cast<std::uint32_t>((needed + window_ - 1) / window_);
    rounds_of_window_ = loses() ? 1 : std::max(shares.rounds, 1U);
    keys_ = frame.make_buffer("fragment keys", 8 * std::uint64_t{window_});
    colors_ = frame.make_buffer("fragment colours", 4 * std::uint64_t{window_});
    last_ = frame.make_buffer("last keys", 8 * frame.pixels());
    states_ = frame.make_buffer("states", loses() ? 0 : kStateBytes * frame.pixels());
    firsts_ = frame.make_buffer("shares of the pool", 4 * (frame.pixels() + 1));
    upload<std::uint32_t>(frame.context, firsts_, shares.firsts);
    if (loses()) tail_ = frame.make_buffer("tail", kTailBytes * frame.pixels());
  }

  void start(Frame& /*frame*/, Recorder& recorder) override {
    recorder.fill(keys_, 0xFFFFFFFFU);
    if (tail_) recorder.fill(tail_, 0);
  }

  [[nodiscard]] bool peels() const override { return true; }
  [[nodiscard]] std::uint64_t known_rounds() const override {
    return std::uint64_t{windows_} * rounds_of_window_;
  }
  void peel(Frame& frame, Recorder& recorder, std::uint32_t round) override {
    recorder.bind(Slot::a, keys_);
    recorder.bind(Slot::b, last_);
    recorder.bind(Slot::c, colors_);
    recorder.bind(Slot::d, firsts_);
    recorder.bind(Slot::state_front, states_);
    if (tail_) recorder.bind(Slot::e, tail_);
    const std::uint32_t round_of_window = round % rounds_of_window_;
    recorder.push().round = round_of_window;
    recorder.push().p = {round / rounds_of_window_ * window_, window_,
                         round_of_window + 1 == rounds_of_window_ ? 1U : 0U, tail_unit(frame)};
    const Constants constants{frame.effect, 0, loses() ? 1U : 0U};
    frame.gather(recorder, "capture/buffers/shares_keys.frag", {});
    recorder.barrier();
    frame.gather(recorder, "capture/buffers/shares_colors.frag", constants);
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute("capture/buffers/fold_shares.comp", constants), frame.tiles_x(),
                      frame.tiles_y());
  }

 private:
  [[nodiscard]] bool loses() const { return overflow_ == Overflow::nearest; }
  [[nodiscard]] bool given_k(const Frame& frame) const {
    return budget_ == Budget::k && frame.options.budget.bytes == 0;
  }
  [[nodiscard]] static std::uint64_t memory(const Frame& frame) {
    return frame.options.budget.bytes != 0 ? frame.options.budget.bytes : kBoundedBytes * frame.pixels();
  }
  // Returns the number of places of the pool.
  [[nodiscard]] std::uint64_t places(const Frame& frame) const {
    if (budget_ == Budget::pool) return frame.capacity();
    if (given_k(frame)) return frame.options.k * frame.pixels();
    const std::uint64_t fixed = kPixelBytes * frame.pixels() + 4;
    return memory(frame) > fixed ? (memory(frame) - fixed) / kPlaceBytes : 0;
  }
  // The unit is chosen so that a sum of absorptions, each at most 16, fits into a word.
  [[nodiscard]] static std::uint32_t tail_unit(const Frame& frame) {
    constexpr std::uint64_t kFinest = 1U << 20U;
    const std::uint64_t fits = ((std::uint64_t{1} << 28U) - 1) / std::max<std::uint64_t>(frame.deepest, 1);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(std::bit_floor(fits), 1, kFinest));
  }

  Budget budget_;
  Overflow overflow_;
  std::uint32_t window_ = 0, windows_ = 1, rounds_of_window_ = 1;
  Buffer keys_, colors_, last_, states_, firsts_, tail_;
};

}  // namespace

std::unique_ptr<Technique> nearest_rounds_in_pool(Overflow overflow) {
  return std::make_unique<NearestRounds>(Budget::pool, overflow);
}

TechniqueEntry multi_k_buffer() {
  return {
      {.name = "multikb",
       .title = "the k nearest fragments a round, until all are there: exact in any memory",
       .paper = "Liu et al. 2009",
       .captures = "all",
       .passes_formula = "1 + 2 ceil(N / K)",
       .bytes_formula = "12 min(N, K) + 44",
       .groups = {OptionGroup::k, OptionGroup::budget},
       .needs_atomics64 = true},
      [] { return std::unique_ptr<Technique>(std::make_unique<NearestRounds>(Budget::k, Overflow::exact)); }};
}

TechniqueEntry bounded() {
  return {
      {.name = "bounded",
       .title = "the nearest fragments a round, as many as the memory budget holds, until all are there",
       .paper = "",
       .captures = "all",
       .passes_formula = "1 + 2 ceil(12 N / (bytes - 44))",
       .bytes_formula = "64, or the memory budget",
       .groups = {OptionGroup::budget},
       .needs_atomics64 = true},
      [] {
        return std::unique_ptr<Technique>(std::make_unique<NearestRounds>(Budget::memory, Overflow::exact));
      }};
}

}  // namespace pellucid::render
