// Internal to the module `asset`: buffer views of EXT_meshopt_compression (and of KHR_meshopt_compression
// where it holds the same bit stream).
#pragma once

#include <span>

#include "asset/json_fields.h"

namespace pellucid {

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential };

struct MeshoptView {
  std::uint64_t count = 0;
  std::uint64_t stride = 0;  // <= 256
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;
};

// `parent` is the buffer view, `compression` its extension object. Fails for what the extension forbids and
// for modes and filters that are not known.
MeshoptView describe_meshopt_view(const Fields& parent, const Fields& compression);

// count * stride bytes. Fails where `source` cannot be such a stream, before allocating where its size shows
// it.
Bytes decode_meshopt_view(const MeshoptView& view, std::span<const std::byte> source,
                          const Fields& compression);

// Mode INDICES.
Bytes encode_meshopt_indices(std::span<const std::uint32_t> values);

}  // namespace pellucid
