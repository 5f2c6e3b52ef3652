// Implements the first two sections of screen_pairs.h: projects a mesh for a viewpoint, and finds the pairs
// of triangles whose bounds overlap with a uniform grid.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "pellucid/sequencing.h"
#include "transparency/graph/screen_pairs.h"

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

// Appends the overlapping pairs that are to be reported in this grid cell.
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

// ------------------------------------------------------------------------------------------------ projection

namespace {

// A face whose image is smaller than this (square radii) is edge-on. It covers no pixel of any real image.
constexpr double kEdgeOnArea = 1e-12;

void project_vertices(const std::vector<Vec3d>& positions, const Viewpoint& viewpoint,
                      std::vector<Vec3d>& out) {
  const ViewAxes axes = view_axes(viewpoint.direction);
  const bool orthographic = std::isinf(viewpoint.distance);
  // Points beside or behind the camera have no image. A camera that is this close is outside every valid
  // range.
  constexpr double kNearest = 1e-3;
  out.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d& p = positions[i];
    const Vec3d q{dot(p, axes.right), dot(p, axes.up), dot(p, axes.direction)};
    const double s =
        orthographic ? 1.0
                     : viewpoint.distance / std::max(viewpoint.distance - q.z, kNearest * viewpoint.distance);
    out[i] = q * s;
  }
}

ScreenTriangle make_screen_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double doubled_area) {
  const Vec3d ab = b - a;
  const Vec3d ac = c - a;
  ScreenTriangle t{};
  const Vec3d* corners[3] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {
    t.x[i] = static_cast<float>(corners[i]->x);
    t.y[i] = static_cast<float>(corners[i]->y);
  }
  t.height = static_cast<float>(a.z);
  t.slope_x = static_cast<float>((ab.z * ac.y - ac.z * ab.y) / doubled_area);
  t.slope_y = static_cast<float>((ac.z * ab.x - ab.z * ac.x) / doubled_area);
  t.min_height = static_cast<float>(std::min({a.z, b.z, c.z}));
  t.max_height = static_cast<float>(std::max({a.z, b.z, c.z}));
  return t;
}

Bounds2 bounds_of(const ScreenTriangle& t) {
  return {std::min({t.x[0], t.x[1], t.x[2]}), std::min({t.y[0], t.y[1], t.y[2]}),
          std::max({t.x[0], t.x[1], t.x[2]}), std::max({t.y[0], t.y[1], t.y[2]})};
}

}  // namespace

ViewAxes view_axes(const Vec3d& direction) {
  const Vec3d helper = std::fabs(direction.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  const Vec3d right = normalized(cross(helper, direction));
  return {right, cross(direction, right), direction};
}

std::vector<Vec3d> unit_positions(const Mesh& mesh, const BoundingSphere& sphere) {
  const double scale = sphere.radius > 0 ? 1.0 / sphere.radius : 0.0;
  std::vector<Vec3d> positions(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), positions.begin(),
                 [&](const Vec3f& p) { return (to_double(p) - sphere.center) * scale; });
  return positions;
}

void project_triangles(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                       const Viewpoint& viewpoint, bool front_only, ScreenTriangles& out) {
  project_vertices(positions, viewpoint, out.vertices);
  out.triangles.clear();
  out.bounds.clear();
  out.nodes.clear();
  out.flipped.assign(triangles.size(), 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3d& a = out.vertices[triangles[t][0]];
    const Vec3d* b = &out.vertices[triangles[t][1]];
    const Vec3d* c = &out.vertices[triangles[t][2]];
    double doubled_area = (b->x - a.x) * (c->y - a.y) - (c->x - a.x) * (b->y - a.y);
    const bool flipped = doubled_area < 0;
    if (flipped) {
      doubled_area = -doubled_area;
      std::swap(b, c);
    }
    out.flipped[t] = flipped ? 1 : 0;
    if (!(doubled_area > kEdgeOnArea) || (flipped && front_only)) continue;
    out.triangles.push_back(make_screen_triangle(a, *b, *c, doubled_area));
    out.bounds.push_back(bounds_of(out.triangles.back()));
    out.nodes.push_back(node_of(t, flipped));
  }
}

// ----------------------------------------------------------------------------------------------- broad phase

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
  // A few large triangles among many small ones would fill many cells. Coarsen the grid until the lists are
  // linear.
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
