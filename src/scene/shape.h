// Internal to the module `scene`: a primitive as it is posed, subdivided where asked for.
#pragma once

#include "pellucid/animation.h"
#include "pellucid/mesh.h"

namespace pellucid {

struct Shape {
  std::vector<Triangle> triangles;
  std::vector<Vec3f> positions;
  RigPrimitive deformation;           // of these vertices
  std::vector<std::uint16_t> joints;  // of a skin: those that some vertex follows, increasing
};

// Without subdivision all is as in the file; with it vertices are welded first, where position, joints and
// morph targets agree.
Shape make_shape(const Mesh& mesh, RigPrimitive deformation, std::uint32_t subdivisions);

}  // namespace pellucid
