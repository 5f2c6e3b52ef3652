// Internal to the module `asset`: one reader per format. Each takes a path, throws Error{bad_input} with one
// clear line.
#pragma once

#include <string>

#include "pellucid/asset.h"

namespace pellucid {

Model read_gltf(const std::string& path, const ReadOptions& options);  // .gltf and .glb
Model read_ply(const std::string& path, const ReadOptions& options);
Model read_obj(const std::string& path, const ReadOptions& options);
Model read_stl(const std::string& path, const ReadOptions& options);
Model read_off(const std::string& path, const ReadOptions& options);

}  // namespace pellucid
