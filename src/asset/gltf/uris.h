// Internal to the module `asset`: converts the two kinds of URI that a glTF may hold in both directions. They
// are data: URIs with base64, and relative references (RFC 3986).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "asset/gltf/document.h"

namespace pellucid {

// The number of characters of a URI that a message shows.
constexpr std::size_t kLongestUri = 100;

bool is_data_uri(std::string_view uri);

// Returns the payload of a base64 data: URI, or nothing if it is malformed.
std::optional<Bytes> decode_data_uri(std::string_view uri);
std::string encode_data_uri(const Bytes& bytes);

// Returns a relative reference as a path with '/'; ".." is legal in glTF. Returns nothing where `uri` has a
// scheme, an authority, an absolute path, a malformed escape, or an escaped NUL.
std::optional<std::string> decode_relative_uri(std::string_view uri);
std::string encode_relative_uri(std::string_view path);

}  // namespace pellucid
