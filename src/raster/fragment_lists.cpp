// fragment_lists.cpp - see fragment_lists.h.
#include "raster/fragment_lists.h"

#include <algorithm>
#include <bit>

namespace pellucid::raster {
namespace {

// Longer lists are sorted by the standard library.
constexpr std::size_t kInsertionLimit = 24;

// Non-negative floats compare like their bits.
std::uint64_t key_of(const Fragment& f) {
  return (std::uint64_t{std::bit_cast<std::uint32_t>(f.depth)} << 32U) | f.node;
}

bool nearer(const Fragment& a, const Fragment& b) {
  return key_of(a) < key_of(b);
}

void sort_two(Fragment& a, Fragment& b) {
  const bool swapped = nearer(b, a);
  const Fragment low = swapped ? b : a;
  const Fragment high = swapped ? a : b;
  a = low;
  b = high;
}

void insertion_sort(std::span<Fragment> list) {
  for (std::size_t i = 1; i < list.size(); ++i) {
    const Fragment moving = list[i];
    const std::uint64_t key = key_of(moving);
    std::size_t place = i;
    for (; place > 0 && key < key_of(list[place - 1]); --place) list[place] = list[place - 1];
    list[place] = moving;
  }
}

// Columns first .. last - 1.
struct Columns {
  std::uint32_t first, last;
};

// Fragments per pixel as differences along each row: a span adds one at its first pixel and takes it back
// after its last. A row has one more counter than pixels. Returns the columns that any span reaches.
Columns count_differences(const Bands& bands, std::uint32_t band, std::span<const BandedSpans> parts,
                          std::vector<std::int32_t>& counters) {
  const std::size_t stride = std::size_t{bands.width} + 1;
  counters.assign(stride * bands.rows_of(band), 0);
  Columns columns{bands.width, 0};
  for (const BandedSpans& part : parts) {
    for (const Span& span : part.band(band)) {
      std::int32_t* first = counters.data() + stride * span.y + span.x;
      ++first[0];
      --first[span.count];
      columns.first = std::min(columns.first, span.x);
      columns.last = std::max(columns.last, span.x + span.count);
    }
  }
  return columns.first < columns.last ? columns : Columns{0, 0};
}

}  // namespace

void sort_fragments(std::span<Fragment> list) {
  switch (list.size()) {
    case 0:
    case 1:
      return;
    case 2:
      sort_two(list[0], list[1]);
      return;
    case 3:
      sort_two(list[0], list[1]);
      sort_two(list[1], list[2]);
      sort_two(list[0], list[1]);
      return;
    case 4:
      sort_two(list[0], list[1]);
      sort_two(list[2], list[3]);
      sort_two(list[0], list[2]);
      sort_two(list[1], list[3]);
      sort_two(list[1], list[2]);
      return;
    default:
      if (list.size() <= kInsertionLimit) {
        insertion_sort(list);
      } else {
        std::sort(list.begin(), list.end(), nearer);
      }
  }
}

std::uint64_t count_fragments(std::span<const BandedSpans> parts, std::uint32_t band) {
  std::uint64_t count = 0;
  for (const BandedSpans& part : parts) count += part.fragments(band);
  return count;
}

void fill_band(const Bands& bands, std::uint32_t band, std::span<const BandedSpans> parts,
               std::uint64_t first, std::vector<std::int32_t>& counters, FragmentBuffer& out) {
  const std::size_t width = bands.width;
  const std::size_t pixels = width * bands.rows_of(band);
  std::uint64_t* const offsets = out.offsets.data() + width * bands.first_row(band);
  Fragment* const fragments = out.fragments.data();
  const Columns columns = count_differences(bands, band, parts, counters);

  // Every offset starts as the end of its pixel's list; filling moves it down to the list's first fragment.
  std::uint64_t end = first;
  for (std::size_t row = 0; row < pixels; row += width) {
    const std::int32_t* differences = counters.data() + row + row / width;
    std::fill_n(offsets + row, columns.first, end);
    std::int32_t count = 0;
    for (std::size_t x = columns.first; x < columns.last; ++x) {
      count += differences[x];
      end += static_cast<std::uint32_t>(count);
      offsets[row + x] = end;
    }
    std::fill_n(offsets + row + columns.last, width - columns.last, end);
  }
  for (const BandedSpans& part : parts) {
    for (const Span& span : part.band(band)) {
      std::uint64_t* const cursor = offsets + width * span.y + span.x;
      const double depth_at_first = span.depth;
      const double step = span.step;
      const float low = span.min_depth;
      const float high = span.max_depth;
      const std::uint32_t node = span.node;
      for (std::uint32_t i = 0; i < span.count; ++i) {
        const auto depth = static_cast<float>(depth_at_first + step * i);
        fragments[--cursor[i]] = {std::min(std::max(depth, low), high), node};
      }
    }
  }

  // The end of a pixel's list is the start of the next.
  for (std::size_t row = 0; row < pixels; row += width) {
    for (std::size_t p = row + columns.first; p < row + columns.last; ++p) {
      const std::uint64_t list_end = p + 1 < pixels ? offsets[p + 1] : end;
      const std::uint64_t count = list_end - offsets[p];
      if (count == 2) {
        sort_two(fragments[offsets[p]], fragments[offsets[p] + 1]);
      } else if (count > 2) {
        sort_fragments({fragments + offsets[p], count});
      }
    }
  }
}

}  // namespace pellucid::raster
