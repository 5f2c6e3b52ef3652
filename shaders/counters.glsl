// Counters that are incremented while drawing. CaptureStats is made from them.
#ifndef COUNTERS_GLSL
#define COUNTERS_GLSL
layout(std430, set = 0, binding = SLOT_COUNTERS) buffer Counters {
  uint next_node;    // allocation in pools
  uint next_back;    // allocation from the end of a pool
  uint captured;     // fragments folded
  uint coplanar;     // captured fragments at the depth of another one of their pixel
  uint overflowed;   // fragments that found no place
  uint active_pixels;  // pixels in which the next round may find something
  uint rounds;
  uint covered;      // pixels with fragments
  uint deepest;      // largest number of fragments of a pixel
  uint coplanar_pixels;
  uint misordered_pixels;  // pixels in which a fragment came too late to be blended in its place
} counters;
#endif
