// Determines exactly which pixel centres a triangle covers. In: three corners on the fixed-point grid. Out:
// the covered run of pixels in every row.
//
// Edge functions are evaluated in integers on vertices snapped to 1/256 pixel. A centre on an edge belongs to
// the triangle if the edge is a top or a left edge. Small triangles, which are nearly all of a dense mesh,
// use a SIMD kernel (Highway, selected at run time) that tests several centres of a row at once in 32 bits.
// For large triangles the covered span of a row is solved in 64 bits.
//
// Based on: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace pellucid::raster {

// A position on the screen, x to the right and y down.
struct FixedPoint {
  std::int32_t x, y;  // 1/256 pixels
};

// Returns twice the signed area. It is positive if a, b, c run clockwise on the screen, with y pointing down.
constexpr std::int64_t twice_area(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{c.x - a.x} * (b.y - a.y);
}

// The pixels first_x .. last_x by first_y .. last_y, both inclusive.
struct PixelBox {
  std::int32_t first_x, first_y, last_x, last_y;
  [[nodiscard]] std::uint32_t columns() const { return static_cast<std::uint32_t>(last_x - first_x + 1); }
  [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(last_y - first_y + 1); }
};
// Returns the pixels of a width x height image whose centres are in the bounding box of a, b, c, or nothing.
std::optional<PixelBox> pixel_box(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c,
                                  std::uint32_t width, std::uint32_t height);

// Three edge functions at the centre of the first pixel of a box, and their steps to the next column and row.
// A centre is covered if none of them is negative. Edges that do not own their points start one lower.
template <class Integer>
struct Edges {
  std::array<Integer, 3> start, step_x, step_y;
};
// Returns the edge functions of a triangle whose corners run clockwise on the screen.
Edges<std::int64_t> make_edges(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c,
                               const PixelBox& box);

// The covered pixels of one row: `count` pixels from box.first_x + first on.
struct RowSpan {
  std::uint32_t first, count;
};
// Returns the covered pixels of row `row` of a box with `columns` columns.
RowSpan cover_row(const Edges<std::int64_t>& edges, std::uint32_t row, std::uint32_t columns);

// ------------------------------------------------------------------------------------------ the SIMD kernel

// A triangle is small if its corners are less than this many pixels apart in x and y.
constexpr std::int32_t kSmallExtent = 64;

struct SmallTriangle {
  Edges<std::int32_t> edges;
  std::uint32_t columns, rows;  // at most kSmallExtent
};
struct SmallRow {
  std::uint8_t first, count;
};
// Writes the covered pixels of all rows of all triangles, one after the other. The length of `rows` is the
// sum of their row counts.
void cover_small(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows);
// Computes the same result without SIMD, one centre at a time.
void cover_small_scalar(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows);

}  // namespace pellucid::raster
