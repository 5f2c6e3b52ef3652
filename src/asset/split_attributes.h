// Internal to the module `asset`: attributes for the vertices that splitting adds to a glTF primitive.
#pragma once

#include "asset/gltf_edit.h"

namespace pellucid {

// Give `json`, the primitive in the editor's document that `primitive` was read from, accessors of its own
// that hold the old vertices and, behind them, primitive.new_vertices. Accessors that were there stay for
// whoever else uses them. Component types and flags stay as they are but for quantised positions, which
// become floats: a new vertex that is off its plane would make new intersections.
void append_split_vertices(DocumentEditor& editor, Json& json, const Primitive& primitive);

}  // namespace pellucid
