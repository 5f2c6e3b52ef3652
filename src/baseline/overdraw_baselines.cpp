// Implements the overdraw section of pellucid/baseline.h: makes a method that can be measured of overdraw
// orders and of each of their baselines.
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pellucid/baseline.h"

namespace pellucid {
namespace {

using Ranks = std::vector<std::vector<std::uint32_t>>;

std::vector<std::uint32_t> stored_order(const OverdrawSubject& subject) {
  std::vector<std::uint32_t> sequence(subject.triangles.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  return sequence;
}

// Draws all key frames in one order.
MeasuredOverdrawMethod single_order(const std::string& name, const OverdrawSubject& subject,
                                    const std::vector<std::uint32_t>& sequence, std::uint32_t cache_size) {
  MeasuredOverdrawMethod method;
  method.name = name;
  method.acmr = acmr_of(subject, {sequence}, cache_size);
  const auto ranks = std::make_shared<const std::vector<std::uint32_t>>(triangle_ranks(sequence));
  method.drawing = {
      name, [ranks](std::uint32_t, const Viewpoint&) { return std::span<const std::uint32_t>(*ranks); }};
  return method;
}

// Draws each key frame in its own order by Sander et al.
MeasuredOverdrawMethod per_frame_orders(const OverdrawSubject& subject, const OverdrawOptions& options) {
  const std::vector<std::uint32_t> cached = cache_order(subject, options.cache_size);
  const auto ranks = std::make_shared<Ranks>();
  MeasuredOverdrawMethod method;
  for (std::uint32_t frame = 0; frame < subject.frames.size(); ++frame) {
    const std::vector<std::uint32_t> sequence =
        static_overdraw_order(subject, frame, cached, options.lambda, options.cache_size);
    method.acmr += acmr_of(subject, {sequence}, options.cache_size);
    ranks->push_back(triangle_ranks(sequence));
  }
  method.name = "per-frame";
  method.buffers = static_cast<std::uint32_t>(subject.frames.size());
  method.acmr /= method.buffers;
  method.drawing = {method.name, [ranks](std::uint32_t frame, const Viewpoint&) {
                      return std::span<const std::uint32_t>((*ranks)[frame]);
                    }};
  return method;
}

// Makes the baseline "meshopt" with the least threshold that leads to at least options.acmr misses per
// triangle. So the baseline may reorder triangles at least as freely as the orders that it is compared with.
MeasuredOverdrawMethod meshopt_baseline(const OverdrawSubject& subject,
                                        const OverdrawBaselineOptions& options) {
  const std::uint32_t cache = options.orders.cache_size;
  float low = 1;
  float high = 3;
  std::vector<std::uint32_t> best = meshopt_overdraw_order(subject, options.rest, high);
  for (int step = 0; step < 12 && acmr_of(subject, {best}, cache) >= options.acmr; ++step) {
    const float middle = 0.5F * (low + high);
    std::vector<std::uint32_t> trial = meshopt_overdraw_order(subject, options.rest, middle);
    if (acmr_of(subject, {trial}, cache) >= options.acmr) {
      high = middle;
      best = std::move(trial);
    } else {
      low = middle;
    }
  }
  return single_order("meshopt", subject, best, cache);
}

}  // namespace

std::uint32_t OverdrawSets::order_count() const {
  std::uint32_t count = 0;
  for (const OverdrawOrders& set : sets) count += static_cast<std::uint32_t>(set.orders.size());
  return count;
}

OverdrawSets order_overdraw_sets(const OverdrawSubject& subject, const std::vector<PosedFrame>& frames,
                                 const OverdrawOptions& options, bool joint) {
  OverdrawSets sets;
  sets.view_level = options.view_level;
  if (joint) {
    sets.sets.push_back(order_overdraw(subject, options));
    sets.set_of.assign(frames.size(), 0);
    sets.frame_in_set.resize(frames.size());
    std::iota(sets.frame_in_set.begin(), sets.frame_in_set.end(), 0U);
    return sets;
  }
  for (std::size_t begin = 0; begin < frames.size();) {
    OverdrawSubject clip{subject.triangles, subject.parts, subject.double_sided, {}};
    std::size_t end = begin;
    for (; end < frames.size() && frames[end].clip == frames[begin].clip; ++end) {
      sets.set_of.push_back(static_cast<std::uint32_t>(sets.sets.size()));
      sets.frame_in_set.push_back(static_cast<std::uint32_t>(end - begin));
      clip.frames.push_back(subject.frames[end]);
    }
    sets.sets.push_back(order_overdraw(clip, options));
    begin = end;
  }
  return sets;
}

MeasuredOverdrawMethod method_of_sets(const std::string& name, const OverdrawSubject& subject,
                                      OverdrawSets sets, std::uint32_t cache_size) {
  struct Data {
    OverdrawSets sets;
    std::vector<Ranks> ranks;  // by set
    ViewPartition partition;
  };
  const auto data = std::make_shared<Data>();
  MeasuredOverdrawMethod method;
  method.name = name;
  method.buffers = sets.order_count();
  for (const OverdrawOrders& set : sets.sets) {
    data->ranks.emplace_back();
    for (std::uint32_t order = 0; order < set.orders.size(); ++order) {
      const std::vector<std::uint32_t> sequence = triangle_order(set, order);
      method.acmr += acmr_of(subject, {sequence}, cache_size);
      data->ranks.back().push_back(triangle_ranks(sequence));
    }
  }
  method.acmr /= method.buffers;
  data->partition = make_partition({PartitionKind::viewpoints, sets.view_level, 0});
  data->sets = std::move(sets);
  method.drawing = {name, [data](std::uint32_t frame, const Viewpoint& viewpoint) {
                      const std::uint32_t set = data->sets.set_of[frame];
                      const std::size_t row =
                          std::size_t{data->sets.frame_in_set[frame]} * data->partition.cell_count();
                      const std::uint32_t cell = find_cell(data->partition, viewpoint.direction);
                      const std::uint32_t order = data->sets.sets[set].cell_orders[row + cell];
                      return std::span<const std::uint32_t>(data->ranks[set][order]);
                    }};
  return method;
}

std::vector<std::uint32_t> meshopt_overdraw_order(const OverdrawSubject& subject,
                                                  const std::vector<Vec3f>& rest, float threshold) {
  std::vector<std::uint32_t> sequence;
  for (std::size_t part = 0; part < subject.parts.size(); ++part) {
    const std::uint32_t begin = subject.parts[part];
    const std::size_t end =
        part + 1 < subject.parts.size() ? subject.parts[part + 1] : subject.triangles.size();
    // meshoptimizer permutes indices. Triangles are found again by their sorted corners.
    std::vector<std::uint32_t> indices;
    for (std::size_t t = begin; t < end; ++t)
      indices.insert(indices.end(), subject.triangles[t].begin(), subject.triangles[t].end());
    if (indices.empty()) continue;
    std::vector<std::uint32_t> cached(indices.size());
    std::vector<std::uint32_t> sorted(indices.size());
    meshopt_optimizeVertexCache(cached.data(), indices.data(), indices.size(), rest.size());
    meshopt_optimizeOverdraw(sorted.data(), cached.data(), cached.size(), &rest.front().x, rest.size(),
                             sizeof(Vec3f), threshold);
    const auto key_of = [](const std::uint32_t* corner) {
      Triangle t{corner[0], corner[1], corner[2]};
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      return t;
    };
    std::vector<std::pair<Triangle, std::uint32_t>> known;
    for (std::size_t i = 0; i < indices.size(); i += 3)
      known.emplace_back(key_of(&indices[i]), static_cast<std::uint32_t>(begin + i / 3));
    std::sort(known.begin(), known.end());
    std::vector<std::uint8_t> used(known.size(), 0);
    for (std::size_t i = 0; i < sorted.size(); i += 3) {
      auto found = std::lower_bound(known.begin(), known.end(), std::pair(key_of(&sorted[i]), 0U));
      while (used[static_cast<std::size_t>(found - known.begin())] != 0) ++found;
      used[static_cast<std::size_t>(found - known.begin())] = 1;
      sequence.push_back(found->second);
    }
  }
  return sequence;
}

std::vector<MeasuredOverdrawMethod> make_overdraw_baselines(const OverdrawSubject& subject,
                                                            const std::vector<PosedFrame>& frames,
                                                            const OverdrawBaselineOptions& options) {
  std::vector<MeasuredOverdrawMethod> baselines;
  const std::uint32_t cache = options.orders.cache_size;
  for (const std::string& name : options.names) {
    if (name == "input") {
      baselines.push_back(single_order(name, subject, stored_order(subject), cache));
    } else if (name == "original") {
      baselines.push_back(single_order(name, subject, cache_order(subject, cache), cache));
    } else if (name == "meshopt") {
      baselines.push_back(meshopt_baseline(subject, options));
    } else if (name == "per-frame") {
      baselines.push_back(per_frame_orders(subject, options.orders));
    } else if (name == "single" || name == "paper") {
      OverdrawOptions orders = options.orders;
      orders.method = OverdrawMethod::paper;
      if (name == "single") orders.buffers = 1;
      baselines.push_back(
          method_of_sets(name, subject, order_overdraw_sets(subject, frames, orders, options.joint), cache));
    } else {
      throw Error(ErrorKind::bad_argument,
                  "there is no overdraw baseline '" + name +
                      "'; choose of input, original, meshopt, per-frame, single, paper, or give all or none");
    }
  }
  return baselines;
}

}  // namespace pellucid
