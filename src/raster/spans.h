// Converts triangles to spans, which are horizontal runs of fragments, and spans to lists of fragments per
// pixel in depth order. In: projected vertices. Out: the offsets and fragments of a FragmentBuffer.
//
// A triangle becomes one span per row. A band is a few rows of the image that fit into the cache of the
// processor with all their fragments. Bands are the unit of parallel work for the lists: the fragments of
// every pixel are counted, the counts are summed up, the lists are filled and then sorted. The keys (depth,
// node) are unique within a pixel, so the result does not depend on the order of the spans.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/coverage.h"
#include "raster/projection.h"

namespace pellucid::raster {

// ---------------------------------------------------------------------------------------- triangles to spans

// A horizontal run of fragments of one triangle.
struct Span {
  double depth, step;          // at the centre of the first pixel, and per pixel
  float min_depth, max_depth;  // of the triangle; depths are clamped to this range
  std::uint32_t node;
  std::uint32_t x, y;  // first pixel; y counts from the first row of the band
  std::uint32_t count;
};

// The division of an image into bands.
struct Bands {
  Bands(std::uint32_t image_width, std::uint32_t image_height);

  [[nodiscard]] std::uint32_t band_of(std::uint32_t y) const { return y >> row_shift; }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t band) const { return band << row_shift; }
  [[nodiscard]] std::uint32_t rows_of(std::uint32_t band) const;

  std::uint32_t width, height;
  std::uint32_t row_shift = 0;  // a band has 2^row_shift rows, the last one perhaps fewer
  std::uint32_t count = 0;
};

// The spans of one part of the mesh, sorted by band.
class BandedSpans {
 public:
  // Removes the spans and keeps the memory.
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

// Converts triangles to spans. Collects small triangles and processes them in batches.
class SpanMaker {
 public:
  SpanMaker(const Projection& projection, Culling culling, BandedSpans& spans);
  // Adds the triangles `first` .. `last` - 1 of a mesh, whose vertices have been projected. Finishes the
  // batch.
  void add(const Mesh& mesh, std::span<const ScreenVertex> vertices, std::size_t first, std::size_t last);

 private:
  // The depth over a triangle, and its node.
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

// ----------------------------------------------------------------------------------- spans to fragment lists

// Sorts fragments by (depth, node). Depths must not be negative. Fastest for lists of at most four fragments.
void sort_fragments(std::span<Fragment> list);

// Returns the number of fragments of one band in all parts.
std::uint64_t count_fragments(std::span<const BandedSpans> parts, std::uint32_t band);

// Writes the offsets and fragments of one band. `first` is the index of its first fragment. `counters` is
// working memory.
void fill_band(const Bands& bands, std::uint32_t band, std::span<const BandedSpans> parts,
               std::uint64_t first, std::vector<std::int32_t>& counters, FragmentBuffer& out);

}  // namespace pellucid::raster
