// Optical depth -log2(1 - alpha): that of several fragments is the sum of theirs, in whatever order they come.
#ifndef OPTICAL_DEPTH_GLSL
#define OPTICAL_DEPTH_GLSL
// `most`: for opaque ones, which have none that is finite.
float optical_depth(float alpha, float most) { return alpha < 1.0 ? min(-log2(1.0 - alpha), most) : most; }
#endif
