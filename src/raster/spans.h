// spans.h - horizontal runs of fragments, sorted into bands of picture rows.
//
// A triangle becomes one span per row; a band is a few rows that fit the processor's cache with all their
// fragments, and the unit of parallel work for the lists (fragment_lists.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raster/coverage.h"
#include "raster/projection.h"

namespace pellucid::raster {

struct Span {
  double depth, step;          // at the first pixel's centre and per pixel
  float min_depth, max_depth;  // of the triangle: what lies outside is rounded
  std::uint32_t node;
  std::uint32_t x, y;  // first pixel; y counts from the band's first row
  std::uint32_t count;
};

// How a picture is cut into bands.
struct Bands {
  Bands(std::uint32_t picture_width, std::uint32_t picture_height);

  [[nodiscard]] std::uint32_t band_of(std::uint32_t y) const { return y >> row_shift; }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t band) const { return band << row_shift; }
  [[nodiscard]] std::uint32_t rows_of(std::uint32_t band) const;

  std::uint32_t width, height;
  std::uint32_t row_shift = 0;  // a band has 2^row_shift rows, the last one perhaps fewer
  std::uint32_t count = 0;
};

// The spans of one part of the mesh, by band.
class BandedSpans {
 public:
  // Forget the spans, keep the memory.
  void reset(const Bands& bands);
  void add(std::uint32_t y, Span span) {
    span.y = y & row_mask_;
    List& list = lists_[y >> row_shift_];
    list.fragments += span.count;
    list.spans.push_back(span);
  }
  [[nodiscard]] const std::vector<Span>& band(std::uint32_t index) const { return lists_[index].spans; }
  [[nodiscard]] std::uint64_t fragments(std::uint32_t band) const { return lists_[band].fragments; }

 private:
  struct List {
    std::vector<Span> spans;
    std::uint64_t fragments = 0;
  };
  std::vector<List> lists_;
  std::uint32_t row_shift_ = 0, row_mask_ = 0;
};

// Turns triangles into spans. Collects small triangles and covers them in batches.
class SpanMaker {
 public:
  SpanMaker(const Projection& projection, Culling culling, BandedSpans& spans);
  // Triangles `first` .. `last` - 1 of the mesh, whose vertices have been projected. Finishes its batch.
  void add(const Mesh& mesh, std::span<const ScreenVertex> vertices, std::size_t first, std::size_t last);

 private:
  // How depth runs over a triangle, and whose fragments they are.
  struct Surface {
    double depth, gradient_x, gradient_y;  // at the centre of the box's first pixel
    float min_depth, max_depth;
    std::uint32_t node;
    std::uint32_t x, y;  // the box's first pixel
  };
  using Corners = std::array<FixedPoint, 3>;
  static constexpr std::size_t kBatch = 64;

  void add_whole(const std::array<const ScreenVertex*, 3>& corners, std::uint32_t triangle);
  void add_clipped(const Mesh& mesh, std::uint32_t triangle);
  void cover(const Corners& corners, const PixelBox& box, const Surface& surface);
  void cover_large(const Corners& corners, const PixelBox& box, const Surface& surface);
  void flush();
  void emit(const Surface& surface, std::uint32_t row, std::uint32_t first, std::uint32_t count);

  const Projection& projection_;
  Culling culling_;
  BandedSpans& spans_;
  std::size_t batched_ = 0, batched_rows_ = 0;
  std::array<SmallTriangle, kBatch> triangles_;
  std::array<Surface, kBatch> surfaces_;
  std::array<SmallRow, kBatch * kSmallExtent> rows_;
};

}  // namespace pellucid::raster
