// coverage.h - which pixel centres a triangle covers, exactly.
//
// Edge functions are evaluated in integers on vertices snapped to 1/256 pixel; a centre on an edge belongs to
// the triangle if that is a top or a left edge. Based on: Pineda, "A Parallel Algorithm for Polygon
// Rasterization", SIGGRAPH 1988. Small triangles, nearly all of a dense mesh, go through a SIMD kernel
// (Highway, chosen at run time) that tests a row of centres at once in 32 bits; large ones solve for the
// covered span of a row in 64 bits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace pellucid::raster {

struct FixedPoint {
  std::int32_t x, y;  // 1/256 pixels
};

// Twice the signed area; positive when a, b, c run clockwise on the screen, y being down.
constexpr std::int64_t twice_area(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{c.x - a.x} * (b.y - a.y);
}

// Pixels first_x .. last_x by first_y .. last_y, both inclusive.
struct PixelBox {
  std::int32_t first_x, first_y, last_x, last_y;
  [[nodiscard]] std::uint32_t columns() const { return static_cast<std::uint32_t>(last_x - first_x + 1); }
  [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(last_y - first_y + 1); }
};
// Pixels of a width x height picture whose centres lie in the bounding box of a, b, c.
std::optional<PixelBox> pixel_box(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c,
                                  std::uint32_t width, std::uint32_t height);

// Three edge functions at the centre of a box's first pixel and their steps to the next column and row. A
// centre is covered where none of them is negative: edges that do not own their points start one lower.
template <class Integer>
struct Edges {
  std::array<Integer, 3> start, step_x, step_y;
};
// a, b, c clockwise on the screen.
Edges<std::int64_t> make_edges(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c,
                               const PixelBox& box);

// The covered pixels of one row: `count` from box.first_x + first on.
struct RowSpan {
  std::uint32_t first, count;
};
// Row `row` of a box `columns` wide.
RowSpan cover_row(const Edges<std::int64_t>& edges, std::uint32_t row, std::uint32_t columns);

// ------------------------------------------------------------------------------------------ the SIMD kernel

// A triangle whose vertices, and therefore box, lie within so many pixels of each other can be small.
constexpr std::int32_t kSmallExtent = 64;

struct SmallTriangle {
  Edges<std::int32_t> edges;
  std::uint32_t columns, rows;  // at most kSmallExtent
};
struct SmallRow {
  std::uint8_t first, count;
};
// Rows of all triangles one after the other; `rows` has the sum of their row counts.
void cover_small(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows);
// The scalar twin: the same result, one centre at a time.
void cover_small_scalar(std::span<const SmallTriangle> triangles, std::span<SmallRow> rows);

}  // namespace pellucid::raster
