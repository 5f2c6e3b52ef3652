// Implements rasterize(): projects the vertices, converts triangles to spans, and spans to fragment lists.
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "pellucid/raster.h"
#include "raster/projection.h"
#include "raster/spans.h"

namespace pellucid {

// The working memory that calls with the same buffer reuse.
struct RasterMemory {
  std::vector<raster::ScreenVertex> vertices;
  std::vector<raster::BandedSpans> parts;
};

namespace {

using raster::BandedSpans;
using raster::Bands;

// Parts of a mesh are rasterised in parallel. Smaller parts do not justify a task.
constexpr std::size_t kMinTrianglesPerPart = 8192;
constexpr std::size_t kVerticesPerTask = 8192;
constexpr std::uint64_t kMaxPixels = 1ULL << 28U;

void check_image(const Camera& camera) {
  const std::uint64_t pixels = std::uint64_t{camera.width} * camera.height;
  if (pixels == 0 || pixels > kMaxPixels || std::max(camera.width, camera.height) > raster::kMaxSide) {
    throw Error(ErrorKind::bad_argument,
                "image size " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                    ": at least one pixel, at most 2^28 and at most 2^20 a side are possible");
  }
  const bool planes_ok = camera.perspective ? camera.near_plane > 0 && camera.near_plane < camera.far_plane
                                            : camera.near_plane < camera.far_plane;
  if (!planes_ok || !(camera.half_height > 0)) {
    throw Error(ErrorKind::bad_argument,
                "camera: half_height must be positive and the near plane nearer than the far plane" +
                    std::string(camera.perspective ? ", and in front of the eye" : ""));
  }
}

// Returns the working memory of `out`. Makes a new one if a copy of `out` shares the old one.
RasterMemory& memory_of(FragmentBuffer& out) {
  if (out.memory == nullptr || out.memory.use_count() > 1) out.memory = std::make_shared<RasterMemory>();
  return *out.memory;
}

void project_all(const raster::Projection& projection, const Mesh& mesh, RasterMemory& memory) {
  memory.vertices.resize(mesh.positions.size());
  parallel_ranges(std::size_t{0}, mesh.positions.size(), kVerticesPerTask,
                  [&](std::size_t begin, std::size_t end) {
                    raster::project(projection, std::span(mesh.positions).subspan(begin, end - begin),
                                    std::span(memory.vertices).subspan(begin, end - begin));
                  });
}

void make_spans(const raster::Projection& projection, const Mesh& mesh, const Bands& bands, Culling culling,
                RasterMemory& memory) {
  const std::size_t triangles = mesh.triangles.size();
  const std::size_t count = std::clamp<std::size_t>(triangles / kMinTrianglesPerPart, 1, 4 * max_threads());
  memory.parts.resize(count);
  parallel_loop(std::size_t{0}, count, [&](std::size_t part) {
    memory.parts[part].reset(bands);
    raster::SpanMaker maker(projection, culling, memory.parts[part]);
    maker.add(mesh, memory.vertices, triangles * part / count, triangles * (part + 1) / count);
  });
}

void make_lists(const Bands& bands, std::span<const BandedSpans> parts, FragmentBuffer& out) {
  std::vector<std::uint64_t> first(std::size_t{bands.count} + 1, 0);
  for (std::uint32_t band = 0; band < bands.count; ++band) {
    first[band + 1] = first[band] + raster::count_fragments(parts, band);
  }
  out.offsets.resize(std::size_t{bands.width} * bands.height + 1);
  out.offsets.back() = first.back();
  out.fragments.resize(first.back());
  parallel_ranges(std::uint32_t{0}, bands.count, 1, [&](std::uint32_t begin, std::uint32_t end) {
    std::vector<std::int32_t> counters;
    for (std::uint32_t band = begin; band != end; ++band) {
      raster::fill_band(bands, band, parts, first[band], counters, out);
    }
  });
}

}  // namespace

std::uint64_t FragmentBuffer::covered_pixels() const {
  std::uint64_t covered = 0;
  for (std::size_t p = 0; p + 1 < offsets.size(); ++p) covered += offsets[p + 1] > offsets[p] ? 1U : 0U;
  return covered;
}

void rasterize(const Mesh& mesh, const Camera& camera, const RasterOptions& options, FragmentBuffer& out) {
  check_image(camera);
  const raster::Projection projection(camera);
  const Bands bands(camera.width, camera.height);
  RasterMemory& memory = memory_of(out);
  out.width = camera.width;
  out.height = camera.height;
  // A thread that waits here must not begin another frame of the caller, which may use the same buffer.
  run_isolated([&] {
    project_all(projection, mesh, memory);
    make_spans(projection, mesh, bands, options.culling, memory);
    make_lists(bands, memory.parts, out);
  });
}

}  // namespace pellucid
