#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/blending/optical_depth.glsl"
// Computes the light that reaches a depth from five sums over the fragments of a pixel: optical depth, and
// its first four power moments over depth. Based on: Muenstermann, Krumpen, Klein, Peters, "Moment-Based
// Order-Independent Transparency", I3D 2018. Bias and overestimation are the values of the paper for sums of
// 32-bit floats.
const float kMostDepth = 8.0;  // limit per fragment, so that an opaque one does not outweigh all others
const float kMomentBias = 5e-7;
const vec4 kBiasedTo = vec4(0.0, 0.375, 0.0, 0.375);
// The share of the optical depth at a fragment itself that counts as lying in front of it.
const float kOverestimation = 0.25;

// Returns the depth that the moments use, -1 to 1. It is logarithmic in distance, so that near depths get a
// larger part of the range.
float moment_depth(float z) {
  if (frame.eye.w == 0.0) return 2.0 * z - 1.0;
  return 2.0 * log2(view_distance(z) * frame.planes.z) / log2(frame.planes.y * frame.planes.z) - 1.0;
}

vec4 moments_of(float z, float depth) {
  const float z2 = z * z;
  return depth * vec4(z, z2, z2 * z, z2 * z2);
}

// Returns the share of the optical depth in front of z. Several measures have the given moments. Among them,
// the one that has a point at z and two more points bounds what can lie in front of z (a Gauss quadrature).
// The Hankel matrix of 1 and the moments is factored as L D L^T.
float share_in_front(vec4 m, float z) {
  const float kLeastPivot = 1e-9;
  const float d1 = max(m.y - m.x * m.x, kLeastPivot);
  const float l21 = (m.z - m.x * m.y) / d1;
  const float d2 = max(m.w - m.y * m.y - l21 * l21 * d1, kLeastPivot);
  // Solve L y = (1, z, z^2) and D L^T c = y.
  const float y1 = z - m.x;
  const float y2 = z * z - m.y - l21 * y1;
  const float c2 = y2 / d2;
  const float c1 = y1 / d1 - l21 * c2;
  const float c0 = 1.0 - m.x * c1 - m.y * c2;
  const float at_z = 1.0 / (1.0 + y1 * y1 / d1 + y2 * y2 / d2);
  // The two other points are the roots of c0 + c1 x + c2 x^2. Their weights follow from the first two
  // moments.
  const float root = sqrt(max(c1 * c1 - 4.0 * c0 * c2, 0.0));
  const float q = -0.5 * (c1 + (c1 < 0.0 ? -root : root));
  const float a = c2 != 0.0 ? q / c2 : 2.0;
  const float b = q != 0.0 ? c0 / q : -2.0;
  const float others = 1.0 - at_z;
  const float at_a = a != b ? (m.x - at_z * z - others * b) / (a - b) : 0.5 * others;
  const float in_front = (a < z ? at_a : 0.0) + (b < z ? others - at_a : 0.0);
  return clamp(in_front + kOverestimation * at_z, 0.0, 1.0);
}

// Returns the light that reaches z. `moments` are sums of moments_of(), and `depth` is the optical depth of
// all fragments.
float light_at(float z, vec4 moments, float depth) {
  if (depth <= 0.0) return 1.0;
  return exp2(-depth * share_in_front(mix(moments / depth, kBiasedTo, kMomentBias), z));
}

#if defined(SUMS)
// First pass: sums up moments and optical depth.
layout(location = 0) out vec4 moments;
layout(location = 1) out float depth_sum;
void main() {
  depth_sum = optical_depth(unpack_color(fragment_color()).a, kMostDepth);
  moments = moments_of(moment_depth(gl_FragCoord.z), depth_sum);
}
#endif

#if defined(COLORS)
// Second pass: adds up colours, weighted by the light that reaches them.
layout(set = 0, binding = SLOT_IMAGE_1) uniform texture2D depth_sums;
layout(set = 0, binding = SLOT_IMAGE_2) uniform texture2D moments;
layout(location = 0) out vec4 sums;
void main() {
  const ivec2 place = ivec2(gl_FragCoord.xy);
  const vec4 c = unpack_color(fragment_color());
  const float light =
      light_at(moment_depth(gl_FragCoord.z), texelFetch(moments, place, 0), texelFetch(depth_sums, place, 0).r);
  sums = vec4(c.rgb, 1.0) * (c.a * light);
}
#endif
