// Internal to the module `asset`: JSON text to a document, safe against hostile text.
#pragma once

#include <string>
#include <string_view>

#include "asset/gltf_document.h"

namespace pellucid {

// Throws Error{bad_input}, beginning with `file`, for text that is no JSON, nests deeper than 128, has an
// object of more than 10,000 keys (ordered objects are searched in linear time), or is longer than 512 MiB.
Json parse_json(std::string_view text, const std::string& file);

}  // namespace pellucid
