// Implements coverage. Highway includes this file once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/coverage.cpp"
#include "raster/coverage.h"

#include <algorithm>
#include <bit>

#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "raster/projection.h"

HWY_BEFORE_NAMESPACE();
namespace pellucid::raster {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The kernel uses single vectors instead of arrays, because some instruction sets have vectors of unknown
// size, which an array cannot hold.
void cover_small_simd(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows) {
  const hn::CappedTag<std::int32_t, 8> tag;
  constexpr std::int32_t kLanes = hn::MaxLanes(tag);
  const auto lane = hn::Iota(tag, 0);
  const auto minus_one = hn::Set(tag, -1);
  SmallRow* row = rows.data();
  for (const SmallTriangle& triangle : triangles) {
    const Edges<std::int32_t>& edges = triangle.edges;
    const auto edge_at = [&](std::size_t k) HWY_ATTR {
      return hn::Add(hn::Set(tag, edges.start[k]), hn::Mul(hn::Set(tag, edges.step_x[k]), lane));
    };
    const auto block_step = [&](std::size_t k) HWY_ATTR { return hn::Set(tag, edges.step_x[k] * kLanes); };
    const auto row_step = [&](std::size_t k) HWY_ATTR { return hn::Set(tag, edges.step_y[k]); };
    auto row0 = edge_at(0);
    auto row1 = edge_at(1);
    auto row2 = edge_at(2);
    const std::uint64_t columns =
        triangle.columns < 64 ? (std::uint64_t{1} << triangle.columns) - 1 : ~std::uint64_t{0};
    for (std::uint32_t y = 0; y < triangle.rows; ++y) {
      // Bit i of the mask is set if column i is covered.
      std::uint64_t mask = 0;
      auto e0 = row0;
      auto e1 = row1;
      auto e2 = row2;
      for (std::uint32_t column = 0; column < triangle.columns; column += kLanes) {
        // The sign bit of the union is set outside of the triangle.
        const auto inside = hn::Gt(hn::Or(e0, hn::Or(e1, e2)), minus_one);
        std::uint64_t bits = 0;
        hn::StoreMaskBits(tag, inside, reinterpret_cast<std::uint8_t*>(&bits));
        mask |= bits << column;
        e0 = hn::Add(e0, block_step(0));
        e1 = hn::Add(e1, block_step(1));
        e2 = hn::Add(e2, block_step(2));
      }
      mask &= columns;
      // A triangle is convex, so the covered pixels of a row have no holes.
      *row++ = {static_cast<std::uint8_t>(mask == 0 ? 0 : std::countr_zero(mask)),
                static_cast<std::uint8_t>(std::popcount(mask))};
      row0 = hn::Add(row0, row_step(0));
      row1 = hn::Add(row1, row_step(1));
      row2 = hn::Add(row2, row_step(2));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace pellucid::raster
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pellucid::raster {
namespace {

HWY_EXPORT(cover_small_simd);

// Returns a / b rounded down, for b > 0.
constexpr std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

// Return the first pixel whose centre is at or right of x (at or below y), and the last one whose centre is
// at or left of it (at or above y).
constexpr std::int32_t first_center(std::int32_t x) {
  return static_cast<std::int32_t>(floor_divide(std::int64_t{x} + kSubpixels / 2 - 1, kSubpixels));
}
constexpr std::int32_t last_center(std::int32_t x) {
  return static_cast<std::int32_t>(floor_divide(std::int64_t{x} - kSubpixels / 2, kSubpixels));
}
static_assert(first_center(128) == 0 && first_center(129) == 1 && first_center(-127) == 0);
static_assert(last_center(128) == 0 && last_center(127) == -1 && last_center(383) == 0);

}  // namespace

std::optional<PixelBox> pixel_box(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c,
                                  std::uint32_t width, std::uint32_t height) {
  const PixelBox box{std::max(first_center(std::min({a.x, b.x, c.x})), 0),
                     std::max(first_center(std::min({a.y, b.y, c.y})), 0),
                     std::min(last_center(std::max({a.x, b.x, c.x})), static_cast<std::int32_t>(width) - 1),
                     std::min(last_center(std::max({a.y, b.y, c.y})), static_cast<std::int32_t>(height) - 1)};
  if (box.first_x > box.last_x || box.first_y > box.last_y) return std::nullopt;
  return box;
}

Edges<std::int64_t> make_edges(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c,
                               const PixelBox& box) {
  const FixedPoint center{box.first_x * kSubpixels + kSubpixels / 2,
                          box.first_y * kSubpixels + kSubpixels / 2};
  const std::array<FixedPoint, 4> corners{a, b, c, a};
  Edges<std::int64_t> edges{};
  for (std::size_t k = 0; k < 3; ++k) {
    const FixedPoint& from = corners[k];
    const FixedPoint& to = corners[k + 1];
    const std::int64_t dx = to.x - from.x;
    const std::int64_t dy = to.y - from.y;
    // The corners run clockwise on the screen, so left edges go up and top edges go right.
    const bool owns_its_points = dy < 0 || (dy == 0 && dx > 0);
    edges.start[k] = dx * (center.y - from.y) - dy * (center.x - from.x) - (owns_its_points ? 0 : 1);
    edges.step_x[k] = -dy * kSubpixels;
    edges.step_y[k] = dx * kSubpixels;
  }
  return edges;
}

RowSpan cover_row(const Edges<std::int64_t>& edges, std::uint32_t row, std::uint32_t columns) {
  std::int64_t first = 0;
  std::int64_t last = std::int64_t{columns} - 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t start = edges.start[k] + edges.step_y[k] * row;
    const std::int64_t step = edges.step_x[k];
    // Solve start + step * x >= 0 for integer x.
    if (step > 0) {
      first = std::max(first, -floor_divide(start, step));
    } else if (step < 0) {
      last = std::min(last, floor_divide(start, -step));
    } else if (start < 0) {
      return {0, 0};
    }
  }
  if (first > last) return {0, 0};
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first + 1)};
}

void cover_small(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows) {
  HWY_DYNAMIC_DISPATCH(cover_small_simd)(triangles, rows);
}

void cover_small_scalar(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows) {
  std::size_t next = 0;
  for (const SmallTriangle& triangle : triangles) {
    const Edges<std::int32_t>& edges = triangle.edges;
    for (std::uint32_t y = 0; y < triangle.rows; ++y) {
      SmallRow& row = rows[next++];
      row = {0, 0};
      for (std::uint32_t x = 0; x < triangle.columns; ++x) {
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
          inside = inside && edges.start[k] + static_cast<std::int32_t>(y) * edges.step_y[k] +
                                     static_cast<std::int32_t>(x) * edges.step_x[k] >=
                                 0;
        }
        if (!inside) continue;
        if (row.count == 0) row.first = static_cast<std::uint8_t>(x);
        ++row.count;
      }
    }
  }
}

}  // namespace pellucid::raster
#endif  // HWY_ONCE
