// fragment_lists.cpp - see fragment_lists.h.
#include "fragment_lists.h"

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

// Fragments per pixel as differences along each row: a span adds one at its first pixel and takes it back
// after its last. A row has one more counter than pixels.
void count_differences(const Bands& bands, std::uint32_t band, std::span<const BandedSpans> parts,
                       std::vector<std::int32_t>& counters) {
  const std::size_t stride = std::size_t{bands.width} + 1;
  counters.assign(stride * bands.rows_of(band), 0);
  for (const BandedSpans& part : parts) {
    for (const Span& span : part.band(band)) {
      std::int32_t* first = counters.data() + stride * span.y + span.x;
      ++first[0];
      --first[span.count];
    }
  }
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
  for (const BandedSpans& part : parts) {
    for (const Span& span : part.band(band)) count += span.count;
  }
  return count;
}

void fill_band(const Bands& bands, std::uint32_t band, std::span<const BandedSpans> parts,
               std::uint64_t first, std::vector<std::int32_t>& counters, FragmentBuffer& out) {
  const std::size_t stride = std::size_t{bands.width} + 1;
  const std::uint32_t rows = bands.rows_of(band);
  std::uint64_t* const offsets = out.offsets.data() + std::size_t{bands.first_row(band)} * bands.width;
  count_differences(bands, band, parts, counters);

  // Every offset starts as the end of its pixel's list; filling moves it down to the list's first fragment.
  std::uint64_t end = first;
  for (std::uint32_t y = 0; y < rows; ++y) {
    const std::int32_t* differences = counters.data() + stride * y;
    std::int32_t count = 0;
    for (std::uint32_t x = 0; x < bands.width; ++x) {
      count += differences[x];
      end += static_cast<std::uint32_t>(count);
      offsets[std::size_t{y} * bands.width + x] = end;
    }
  }
  Fragment* const fragments = out.fragments.data();
  for (const BandedSpans& part : parts) {
    for (const Span& span : part.band(band)) {
      std::uint64_t* cursor = offsets + std::size_t{span.y} * bands.width + span.x;
      for (std::uint32_t i = 0; i < span.count; ++i) {
        const auto depth = static_cast<float>(span.depth + span.step * i);
        fragments[--cursor[i]] = {std::min(std::max(depth, span.min_depth), span.max_depth), span.node};
      }
    }
  }

  // The end of a pixel's list is the start of the next.
  const std::size_t pixels = std::size_t{rows} * bands.width;
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::uint64_t list_end = p + 1 < pixels ? offsets[p + 1] : end;
    if (list_end - offsets[p] > 1) sort_fragments({fragments + offsets[p], list_end - offsets[p]});
  }
}

}  // namespace pellucid::raster
