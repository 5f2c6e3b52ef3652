// Optical depth -log2(1 - alpha). The optical depth of several fragments is the sum of theirs, in any order.
#ifndef OPTICAL_DEPTH_GLSL
#define OPTICAL_DEPTH_GLSL
// `most` is the value for opaque fragments, whose optical depth is infinite.
float optical_depth(float alpha, float most) { return alpha < 1.0 ? min(-log2(1.0 - alpha), most) : most; }
#endif
