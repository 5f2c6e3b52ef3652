// pellucid/model_camera.h - module `asset`: the cameras of a glTF model. Format: glTF 2.0, section 3.10.
#pragma once

#include <string>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

// Looks along its own -z, +y is up.
struct ModelCamera {
  std::string name;  // of the camera or, where it has none, of its node
  Mat4 world;        // as the default scene places it at rest
  bool perspective = true;
  double half_height = 1;  // perspective: tangent of half the vertical angle; else half the picture's height
};

// Of the default scene, in the sequence of its nodes; none in other formats. Throws Error{bad_input} naming
// the file and the place.
std::vector<ModelCamera> read_cameras(const Model& model);

}  // namespace pellucid
