// Internal to the module `asset`: the two kinds of uri that a glTF may hold, data: and relative references
// (RFC 3986).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "asset/gltf_document.h"

namespace pellucid {

// Of one in a message.
constexpr std::size_t kLongestUri = 100;

bool is_data_uri(std::string_view uri);

// The payload of a base64 data: uri; empty where it is malformed.
std::optional<Bytes> decode_data_uri(std::string_view uri);
std::string encode_data_uri(const Bytes& bytes);

// A relative reference as a path with '/' (".." is legal glTF); empty where `uri` has a scheme, an authority,
// an absolute path, or a malformed or NUL escape.
std::optional<std::string> decode_relative_uri(std::string_view uri);
std::string encode_relative_uri(std::string_view path);

}  // namespace pellucid
