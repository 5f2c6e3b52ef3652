// Internal to the module `asset`: converts the two kinds of URI that a glTF may hold in both directions. They
// are data: URIs, and relative references (RFC 3986).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "asset/gltf/document.h"

namespace pellucid {

// The number of characters of a URI that a message shows.
constexpr std::size_t kLongestUri = 100;

bool is_data_uri(std::string_view uri);

// Returns the payload of a data: URI in base64 or percent-encoding, or nothing if it is malformed.
std::optional<Bytes> decode_data_uri(std::string_view uri);
std::string encode_data_uri(const Bytes& bytes);

// Returns a relative reference as a path with '/'; ".." is legal in glTF. Returns nothing where `uri` has a
// scheme, an authority, an absolute path, or an escaped NUL. A '%' without two hexadecimal digits stands for
// itself.
std::optional<std::string> decode_relative_uri(std::string_view uri);
// Returns the same for a file in `folder`. If there is no such file, but one whose name is the URI as it is
// written, returns that.
std::optional<std::string> relative_path(const std::filesystem::path& folder, std::string_view uri);
std::string encode_relative_uri(std::string_view path);

}  // namespace pellucid
