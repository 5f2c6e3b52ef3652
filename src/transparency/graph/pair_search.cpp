// Broad phase over a uniform grid: see pair_search.h.
#include "transparency/graph/pair_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transparency/graph/pair_search.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#ifndef PELLUCID_PAIR_SEARCH_ENTRIES
#define PELLUCID_PAIR_SEARCH_ENTRIES
namespace pellucid {
// The entries of one grid cell.
struct CellEntries {
  const float *min_x, *min_y, *max_x, *max_y;
  const std::int32_t *begins, *index;
  std::size_t count;
};
}  // namespace pellucid
#endif

HWY_BEFORE_NAMESPACE();
namespace pellucid {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "transparency/graph/each_lane-inl.h"

// Append the overlapping pairs of one grid cell that are this cell's to report.
void pairs_in_cell(const CellEntries& cell, std::vector<CandidatePair>& pairs) {
  constexpr hn::ScalableTag<float> kFloats;
  constexpr hn::RebindToSigned<decltype(kFloats)> kInts;
  const std::size_t lanes = hn::Lanes(kFloats);
  const auto both_begin = hn::Set(kInts, 3);
  for (std::size_t i = 0; i + 1 < cell.count; ++i) {
    const auto min_x = hn::Set(kFloats, cell.min_x[i]);
    const auto min_y = hn::Set(kFloats, cell.min_y[i]);
    const auto max_x = hn::Set(kFloats, cell.max_x[i]);
    const auto max_y = hn::Set(kFloats, cell.max_y[i]);
    const auto begins = hn::Set(kInts, cell.begins[i]);
    for (std::size_t j = i + 1; j < cell.count; j += lanes) {
      // The arrays are padded by one vector, so that reading past the cell's end is harmless.
      const auto in_cell = hn::FirstN(kFloats, std::min(lanes, cell.count - j));
      const auto overlap_x = hn::And(hn::Lt(hn::LoadU(kFloats, cell.min_x + j), max_x),
                                     hn::Lt(min_x, hn::LoadU(kFloats, cell.max_x + j)));
      const auto overlap_y = hn::And(hn::Lt(hn::LoadU(kFloats, cell.min_y + j), max_y),
                                     hn::Lt(min_y, hn::LoadU(kFloats, cell.max_y + j)));
      const auto ours = hn::Eq(hn::Or(begins, hn::LoadU(kInts, cell.begins + j)), both_begin);
      const auto mask = hn::And(hn::And(hn::RebindMask(kInts, hn::And(in_cell, overlap_x)), ours),
                                hn::RebindMask(kInts, overlap_y));
      for_each_lane(kInts, mask, [&](std::size_t lane) {
        pairs.push_back(
            {static_cast<std::uint32_t>(cell.index[i]), static_cast<std::uint32_t>(cell.index[j + lane])});
      });
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace pellucid
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pellucid {
namespace {

HWY_EXPORT(pairs_in_cell);

constexpr std::size_t kPadding = 64;     // floats: one vector of any target
constexpr double kCellsPerExtent = 1.5;  // grid cell width in mean triangle extents
constexpr std::int32_t kMostColumns = 2048;
constexpr std::uint64_t kMostEntriesPerTriangle = 12;

}  // namespace

PairSearch::CellRange PairSearch::cells_of(const Bounds2& b) const {
  const auto cell = [&](float value, float origin, std::int32_t count) {
    return std::clamp(static_cast<std::int32_t>((value - origin) * scale_), 0, count - 1);
  };
  return {cell(b.min_x, origin_x_, columns_), cell(b.min_y, origin_y_, rows_),
          cell(b.max_x, origin_x_, columns_), cell(b.max_y, origin_y_, rows_)};
}

void PairSearch::choose_grid(const std::vector<Bounds2>& bounds) {
  Bounds2 all = bounds.front();
  double extents = 0;
  for (const Bounds2& b : bounds) {
    all = {std::min(all.min_x, b.min_x), std::min(all.min_y, b.min_y), std::max(all.max_x, b.max_x),
           std::max(all.max_y, b.max_y)};
    extents += 0.5 * (static_cast<double>(b.max_x - b.min_x) + static_cast<double>(b.max_y - b.min_y));
  }
  origin_x_ = all.min_x;
  origin_y_ = all.min_y;
  const double width = std::max(static_cast<double>(all.max_x - all.min_x), 1e-9);
  const double height = std::max(static_cast<double>(all.max_y - all.min_y), 1e-9);
  double cell = std::max(kCellsPerExtent * extents / static_cast<double>(bounds.size()),
                         std::max(width, height) / kMostColumns);
  // Few large triangles among many small ones would fill many cells: coarsen until the lists stay linear.
  for (;; cell *= 1.5) {
    scale_ = static_cast<float>(1.0 / cell);
    columns_ = std::min(kMostColumns, static_cast<std::int32_t>(width / cell) + 1);
    rows_ = std::min(kMostColumns, static_cast<std::int32_t>(height / cell) + 1);
    std::uint64_t entries = 0;
    for (const Bounds2& b : bounds) {
      const CellRange r = cells_of(b);
      entries += static_cast<std::uint64_t>(r.x1 - r.x0 + 1) * static_cast<std::uint64_t>(r.y1 - r.y0 + 1);
    }
    if (entries <= kMostEntriesPerTriangle * bounds.size() || columns_ * rows_ == 1) return;
  }
}

void PairSearch::fill_grid(const std::vector<Bounds2>& bounds) {
  const auto cell_id = [&](std::int32_t x, std::int32_t y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  };
  const auto cell_count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  starts_.assign(cell_count + 1, 0);
  for (const Bounds2& b : bounds) {
    const CellRange r = cells_of(b);
    for (std::int32_t y = r.y0; y <= r.y1; ++y) {
      for (std::int32_t x = r.x0; x <= r.x1; ++x) ++starts_[cell_id(x, y) + 1];
    }
  }
  for (std::size_t i = 0; i < cell_count; ++i) starts_[i + 1] += starts_[i];
  const std::size_t padded = starts_.back() + kPadding;
  for (auto* values : {&min_x_, &min_y_, &max_x_, &max_y_}) values->resize(padded);
  begins_.resize(padded);
  index_.resize(padded);

  cursor_.assign(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const Bounds2& b = bounds[i];
    const CellRange r = cells_of(b);
    for (std::int32_t y = r.y0; y <= r.y1; ++y) {
      for (std::int32_t x = r.x0; x <= r.x1; ++x) {
        const std::uint32_t slot = cursor_[cell_id(x, y)]++;
        min_x_[slot] = b.min_x;
        min_y_[slot] = b.min_y;
        max_x_[slot] = b.max_x;
        max_y_[slot] = b.max_y;
        begins_[slot] = (x == r.x0 ? 1 : 0) | (y == r.y0 ? 2 : 0);
        index_[slot] = static_cast<std::int32_t>(i);
      }
    }
  }
}

void PairSearch::find(const std::vector<Bounds2>& bounds, std::vector<CandidatePair>& pairs) {
  pairs.clear();
  if (bounds.size() < 2) return;
  choose_grid(bounds);
  fill_grid(bounds);
  const auto pairs_of = HWY_DYNAMIC_DISPATCH(pairs_in_cell);
  for (std::size_t c = 0; c + 1 < starts_.size(); ++c) {
    const std::size_t s = starts_[c];
    pairs_of({&min_x_[s], &min_y_[s], &max_x_[s], &max_y_[s], &begins_[s], &index_[s], starts_[c + 1] - s},
             pairs);
  }
}

}  // namespace pellucid
#endif
