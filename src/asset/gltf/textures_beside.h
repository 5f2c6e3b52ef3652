// Internal to the module `asset`: textures in files beside a glTF, which a copy of the glTF in another folder
// needs, too.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "asset/gltf/edit.h"

namespace pellucid {

using SideFile = std::pair<std::string, Bytes>;  // path and content

// Changes the images of the document, which was read from document().path, so that the file that is written
// to `output` finds them. With `embed`, and for a .glb in another folder, they become part of its data. For a
// .gltf in another folder returns the copies to write, which keep their relative paths unless these lead out
// of the folder or belong to other files. Files that are missing stay named as they are, with a note.
std::vector<SideFile> carry_textures(DocumentEditor& editor, const std::string& output, bool embed,
                                     std::vector<std::string>& notes);

}  // namespace pellucid
