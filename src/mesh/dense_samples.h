// Internal to the module `mesh`: samples of high depth complexity, stand-ins for the scenes of the variable
// k-buffer paper (Vasilakis et al., Eurographics 2017, Table 2).
#pragma once

#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

// Curly strands that hang from half an ellipsoid.
std::vector<SamplePart> make_hair(double detail);
// Thin discs in all directions, in a cloud.
std::vector<SamplePart> make_smoke(double detail);
// Rows of `bottles` behind each other.
std::vector<SamplePart> make_shelf(const std::vector<SamplePart>& bottles);
// Plants of many leaves behind panes of glass.
std::vector<SamplePart> make_greenhouse(double detail);

}  // namespace pellucid
