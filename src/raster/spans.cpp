// Implements spans and fragment lists.
#include "raster/spans.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

namespace pellucid::raster {

// ---------------------------------------------------------------------------------------- triangles to spans

namespace {

// Pixels per band. Their counters and two or three fragments each fit into a second-level cache.
constexpr std::uint32_t kBandPixels = 1U << 14U;

constexpr double center(std::int32_t pixel) {
  return pixel + 0.5;
}

// Returns the depth plane through three unsnapped screen vertices. Its gradients are not finite if the
// triangle has no area on the screen.
Projection::Plane plane_through(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  const double abx = b.x - a.x, aby = b.y - a.y, abd = b.depth - a.depth;
  const double acx = c.x - a.x, acy = c.y - a.y, acd = c.depth - a.depth;
  const double inverse = 1.0 / (abx * acy - acx * aby);
  return {a.depth, (abd * acy - acd * aby) * inverse, (abx * acd - acx * abd) * inverse};
}

float clamped_depth(double depth) {
  return static_cast<float>(std::clamp(depth, 0.0, 1.0));
}

FixedPoint fixed(const ScreenVertex& v) {
  return {v.fixed_x, v.fixed_y};
}

bool is_small(const std::array<FixedPoint, 3>& c) {
  constexpr std::int32_t kLimit = kSmallExtent * kSubpixels;
  const auto [min_x, max_x] = std::minmax({c[0].x, c[1].x, c[2].x});
  const auto [min_y, max_y] = std::minmax({c[0].y, c[1].y, c[2].y});
  return max_x - min_x < kLimit && max_y - min_y < kLimit;
}

Edges<std::int32_t> narrowed(const Edges<std::int64_t>& wide) {
  Edges<std::int32_t> edges{};
  for (std::size_t k = 0; k < 3; ++k) {
    edges.start[k] = static_cast<std::int32_t>(wide.start[k]);
    edges.step_x[k] = static_cast<std::int32_t>(wide.step_x[k]);
    edges.step_y[k] = static_cast<std::int32_t>(wide.step_y[k]);
  }
  return edges;
}

// On the screen y points down. A face that is counter-clockwise in space therefore has a negative area.
bool is_back_facing(std::int64_t area) {
  return area > 0;
}

}  // namespace

Bands::Bands(std::uint32_t image_width, std::uint32_t image_height)
    : width(image_width), height(image_height) {
  while (row_shift < 16 && (std::uint64_t{2} << row_shift) * width <= kBandPixels) ++row_shift;
  count = (height + (1U << row_shift) - 1) >> row_shift;
}

std::uint32_t Bands::rows_of(std::uint32_t band) const {
  return std::min(1U << row_shift, height - first_row(band));
}

void BandedSpans::reset(const Bands& bands) {
  row_shift_ = bands.row_shift;
  row_mask_ = (1U << bands.row_shift) - 1;
  lists_.resize(bands.count);
  for (List& list : lists_) {
    list.spans.clear();
    list.fragments = 0;
  }
}

SpanMaker::SpanMaker(const Projection& projection, Culling culling, BandedSpans& spans)
    : projection_(projection), culling_(culling), spans_(spans) {}

void SpanMaker::add(const Mesh& mesh, std::span<const ScreenVertex> vertices, std::size_t first,
                    std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const Triangle& t = mesh.triangles[i];
    const ScreenVertex& a = vertices[t[0]];
    const ScreenVertex& b = vertices[t[1]];
    const ScreenVertex& c = vertices[t[2]];
    const auto triangle = static_cast<std::uint32_t>(i);
    const int any = a.outside | b.outside | c.outside;
    if (any == 0) {
      add_whole({&a, &b, &c}, triangle);
    } else if ((any & kNotFinite) == 0 && (a.outside & b.outside & c.outside) == 0) {
      add_clipped(mesh, triangle);
    }
  }
  flush();
}

void SpanMaker::add_whole(const std::array<const ScreenVertex*, 3>& v, std::uint32_t triangle) {
  Corners corners{fixed(*v[0]), fixed(*v[1]), fixed(*v[2])};
  const std::optional<PixelBox> box =
      pixel_box(corners[0], corners[1], corners[2], projection_.camera().width, projection_.camera().height);
  if (!box) return;
  const std::int64_t area = twice_area(corners[0], corners[1], corners[2]);
  if (area == 0) return;
  const bool back = is_back_facing(area);
  if (back && culling_ == Culling::back) return;
  if (area < 0) std::swap(corners[1], corners[2]);

  const Projection::Plane plane = plane_through(*v[0], *v[1], *v[2]);
  const auto [near, far] = std::minmax({v[0]->depth, v[1]->depth, v[2]->depth});
  Surface surface{};
  if (std::isfinite(plane.gradient_x) && std::isfinite(plane.gradient_y)) {
    surface.gradient_x = plane.gradient_x;
    surface.gradient_y = plane.gradient_y;
  }
  surface.depth = v[0]->depth + surface.gradient_x * (center(box->first_x) - v[0]->x) +
                  surface.gradient_y * (center(box->first_y) - v[0]->y);
  surface.min_depth = clamped_depth(near);
  surface.max_depth = clamped_depth(far);
  surface.node = 2 * triangle + (back ? 1 : 0);
  cover(corners, *box, surface);
}

void SpanMaker::add_clipped(const Mesh& mesh, std::uint32_t triangle) {
  std::array<Vec3d, 3> view;
  for (std::size_t k = 0; k < 3; ++k) view[k] = projection_.view(mesh.positions[mesh.triangles[triangle][k]]);
  const ClippedPolygon polygon = clip_triangle(projection_, view);
  const std::size_t count = polygon.corners().size();
  if (count < 3) return;

  // The facing is that of the whole snapped polygon.
  std::array<ScreenVertex, ClippedPolygon::kMaxCorners> v;
  for (std::size_t k = 0; k < count; ++k) v[k] = projection_.screen(polygon.corners()[k]);
  std::int64_t area = 0;
  for (std::size_t k = 2; k < count; ++k) area += twice_area(fixed(v[0]), fixed(v[k - 1]), fixed(v[k]));
  if (area == 0) return;
  const bool back = is_back_facing(area);
  if (back && culling_ == Culling::back) return;

  Projection::Plane plane = projection_.depth_plane(view[0], view[1], view[2]);
  double near = v[0].depth;
  double far = v[0].depth;
  for (std::size_t k = 1; k < count; ++k) {
    near = std::min(near, v[k].depth);
    far = std::max(far, v[k].depth);
  }
  // A triangle seen edge-on has no depth plane over the screen.
  if (!std::isfinite(plane.offset + plane.gradient_x + plane.gradient_y)) plane = {near, 0, 0};

  // Cover the polygon as a fan. Rounding may reverse a sliver of the fan, which then covers nothing.
  for (std::size_t k = 2; k < count; ++k) {
    Corners corners{fixed(v[0]), fixed(v[k - 1]), fixed(v[k])};
    const std::int64_t part = twice_area(corners[0], corners[1], corners[2]);
    if (part == 0 || is_back_facing(part) != back) continue;
    if (part < 0) std::swap(corners[1], corners[2]);
    const std::optional<PixelBox> box = pixel_box(corners[0], corners[1], corners[2],
                                                  projection_.camera().width, projection_.camera().height);
    if (!box) continue;
    Surface surface{};
    surface.gradient_x = plane.gradient_x;
    surface.gradient_y = plane.gradient_y;
    surface.depth =
        plane.offset + plane.gradient_x * center(box->first_x) + plane.gradient_y * center(box->first_y);
    surface.min_depth = clamped_depth(near);
    surface.max_depth = clamped_depth(far);
    surface.node = 2 * triangle + (back ? 1 : 0);
    cover(corners, *box, surface);
  }
}

void SpanMaker::cover(const Corners& corners, const PixelBox& box, const Surface& unplaced) {
  Surface surface = unplaced;
  surface.x = static_cast<std::uint32_t>(box.first_x);
  surface.y = static_cast<std::uint32_t>(box.first_y);
  if (!is_small(corners)) {
    cover_large(corners, box, surface);
    return;
  }
  triangles_[batched_] = {narrowed(make_edges(corners[0], corners[1], corners[2], box)), box.columns(),
                          box.rows()};
  surfaces_[batched_] = surface;
  batched_rows_ += box.rows();
  if (++batched_ == kBatch) flush();
}

void SpanMaker::cover_large(const Corners& corners, const PixelBox& box, const Surface& surface) {
  const Edges<std::int64_t> edges = make_edges(corners[0], corners[1], corners[2], box);
  for (std::uint32_t row = 0; row < box.rows(); ++row) {
    const RowSpan span = cover_row(edges, row, box.columns());
    if (span.count > 0) emit(surface, row, span.first, span.count);
  }
}

void SpanMaker::flush() {
  cover_small({triangles_.data(), batched_}, {rows_.data(), batched_rows_});
  const SmallRow* row = rows_.data();
  for (std::size_t i = 0; i < batched_; ++i) {
    for (std::uint32_t y = 0; y < triangles_[i].rows; ++y, ++row) {
      if (row->count > 0) emit(surfaces_[i], y, row->first, row->count);
    }
  }
  batched_ = 0;
  batched_rows_ = 0;
}

void SpanMaker::emit(const Surface& surface, std::uint32_t row, std::uint32_t first, std::uint32_t count) {
  Span span{};
  span.depth = surface.depth + surface.gradient_y * row + surface.gradient_x * first;
  span.step = surface.gradient_x;
  span.min_depth = surface.min_depth;
  span.max_depth = surface.max_depth;
  span.node = surface.node;
  span.x = surface.x + first;
  span.count = count;
  spans_.add(surface.y + row, span);
}

// ----------------------------------------------------------------------------------- spans to fragment lists

namespace {

// The standard library sorts longer lists.
constexpr std::size_t kInsertionLimit = 24;

// Returns a key that sorts by depth, then by node. Non-negative floats compare like their bits.
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

// The columns first .. last - 1.
struct Columns {
  std::uint32_t first, last;
};

// Counts the fragments per pixel as differences along each row: a span adds one at its first pixel and
// subtracts one after its last. A row has one more counter than pixels. Returns the columns that any span
// covers.
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

  // Every offset starts at the end of its pixel's list. Filling moves it to the first fragment of the list.
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
