#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
// Draws the far side of the box of a group of triangles (src/render/scene/culling.h) and discards the samples
// in which the box does not reach into the depths that are still to be peeled. With the depth test (IMAGE_1
// is the last layer) these are all depths from that layer on, because coplanar fragments may be left in it.
// Without the depth test (SEARCH, A) they are the depths from the current near end to the current far end.
layout(location = 0) in vec3 world_position;
#if defined(SEARCH)
#include "capture/peeling/layers.glsl"
struct Box {
  float low[3], high[3];
};
layout(std430, set = 0, binding = SLOT_E) readonly buffer Boxes { Box boxes[]; };

// Returns the key of the depth at which the ray through this fragment enters the box, or 0 if that is behind
// the eye.
uint entry_key() {
  const Box box = boxes[push.p0];
  const bool perspective = frame.eye.w != 0.0;
  const vec3 along = perspective ? world_position - frame.eye.xyz : -frame.to_viewer.xyz;
  const vec3 low = vec3(box.low[0], box.low[1], box.low[2]);
  const vec3 high = vec3(box.high[0], box.high[1], box.high[2]);
  float entry = perspective ? -1.0 : -1e30;
  for (int axis = 0; axis < 3; ++axis) {
    if (abs(along[axis]) < 1e-12) continue;
    const float a = (low[axis] - world_position[axis]) / along[axis];
    const float b = (high[axis] - world_position[axis]) / along[axis];
    entry = max(entry, min(a, b));
  }
  const vec4 clip = frame.clip_from_world * vec4(world_position + along * min(entry, 0.0), 1.0);
  return clip.w > 0.0 && clip.z > 0.0 ? key_of(min(clip.z / clip.w, 1.0)) : 0u;
}

bool is_left(uint pixel) {
  const uint near = depths[near_end(pixel)].x;
#if SIDES == 2
  const uint far = depths[far_end(pixel)].x;
#else
  const uint far = 0u;
#endif
  if (near == kNone && far == 0u) return false;
  const uint first = near != kNone ? near : far;
#if SIDES == 2
  const uint last = far != 0u ? far : near;
#else
  const uint last = kNone;
#endif
  return key_of(gl_FragCoord.z) >= first && entry_key() <= last;
}
#else
layout(set = 0, binding = SLOT_IMAGE_1) uniform texture2D layer;
bool is_left(uint pixel) { return gl_FragCoord.z >= texelFetch(layer, ivec2(gl_FragCoord.xy), 0).x; }
#endif

void main() {
  if (!is_left(pixel_index(uvec2(gl_FragCoord.xy)))) discard;
}
