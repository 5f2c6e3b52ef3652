// Compressed buffer views: see meshopt_view.h. Format: EXT_meshopt_compression (Khronos, ratified), version 0
// of the attribute codec and version 1 of the index codecs, through meshoptimizer.
#include "asset/meshopt_view.h"

#include <meshoptimizer.h>

#include <algorithm>

namespace pellucid {
namespace {

// No codec expands more: 16 attribute bytes from 2 bits; the constant covers headers and tails.
constexpr std::uint64_t kMaxExpansion = 64;
constexpr std::uint64_t kExpansionSlack = 1U << 16U;

MeshoptMode parse_mode(const Fields& compression) {
  const std::string mode = compression.text("mode");
  if (mode == "ATTRIBUTES") return MeshoptMode::attributes;
  if (mode == "TRIANGLES") return MeshoptMode::triangles;
  if (mode == "INDICES") return MeshoptMode::indices;
  compression.fail("mode " + mode.substr(0, 40) + " cannot be decoded");
}

MeshoptFilter parse_filter(const Fields& compression) {
  const std::string filter = compression.text_or("filter", "NONE");
  if (filter == "NONE") return MeshoptFilter::none;
  if (filter == "OCTAHEDRAL") return MeshoptFilter::octahedral;
  if (filter == "QUATERNION") return MeshoptFilter::quaternion;
  if (filter == "EXPONENTIAL") return MeshoptFilter::exponential;
  compression.fail("filter " + filter.substr(0, 40) + " cannot be decoded");
}

bool stride_is_legal(const MeshoptView& view) {
  if (view.mode != MeshoptMode::attributes) {
    return (view.stride == 2 || view.stride == 4) && view.filter == MeshoptFilter::none;
  }
  if (view.stride == 0 || view.stride % 4 != 0 || view.stride > 256) return false;
  if (view.filter == MeshoptFilter::octahedral) return view.stride == 4 || view.stride == 8;
  if (view.filter == MeshoptFilter::quaternion) return view.stride == 8;
  return true;
}

void apply_filter(const MeshoptView& view, Bytes& bytes) {
  switch (view.filter) {
    case MeshoptFilter::none:
      break;
    case MeshoptFilter::octahedral:
      meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
      break;
    case MeshoptFilter::quaternion:
      meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
      break;
    case MeshoptFilter::exponential:
      meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
      break;
  }
}

}  // namespace

MeshoptView describe_meshopt_view(const Fields& parent, const Fields& compression) {
  MeshoptView view;
  view.count = compression.index("count");
  view.stride = compression.index("byteStride");
  view.mode = parse_mode(compression);
  view.filter = parse_filter(compression);
  if (!stride_is_legal(view))
    compression.fail("byteStride " + std::to_string(view.stride) + " does not fit its mode");
  if (view.mode == MeshoptMode::triangles && view.count % 3 != 0)
    compression.fail("count is not a multiple of 3");
  const std::uint64_t length = parent.index("byteLength");
  if (view.count > length || view.count * view.stride != length) {
    compression.fail("count * byteStride is not the buffer view's byteLength");
  }
  return view;
}

Bytes decode_meshopt_view(const MeshoptView& view, std::span<const std::byte> source,
                          const Fields& compression) {
  const std::uint64_t size = view.count * view.stride;
  if (size > kMaxExpansion * source.size() + kExpansionSlack) {
    compression.fail("the compressed data is too short for " + std::to_string(view.count) + " elements");
  }
  Bytes bytes(size);
  if (view.count == 0) return bytes;
  const auto* encoded = reinterpret_cast<const unsigned char*>(source.data());
  int error = 0;
  switch (view.mode) {
    case MeshoptMode::attributes:
      error = meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, encoded, source.size());
      break;
    case MeshoptMode::triangles:
      error = meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, encoded, source.size());
      break;
    case MeshoptMode::indices:
      error = meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, encoded, source.size());
      break;
  }
  if (error != 0) {
    compression.fail("the compressed data is damaged or in a newer format than can be decoded (code " +
                     std::to_string(error) + ")");
  }
  apply_filter(view, bytes);
  return bytes;
}

Bytes encode_meshopt_indices(std::span<const std::uint32_t> values) {
  const std::uint32_t largest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  // The extension wants version 1 of the stream; meshoptimizer keeps the choice in a global, for every caller
  // alike.
  meshopt_encodeIndexVersion(1);
  Bytes bytes(meshopt_encodeIndexSequenceBound(values.size(), std::size_t{largest} + 1));
  const std::size_t used = meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(bytes.data()),
                                                       bytes.size(), values.data(), values.size());
  bytes.resize(used);
  return bytes;
}

}  // namespace pellucid
