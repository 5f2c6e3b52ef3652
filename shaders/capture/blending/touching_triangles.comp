#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/samples.glsl"
#include "resolve/marked_tiles.glsl"
// Writes an index buffer, in any order, of the triangles of a range that touch marked tiles of 8 x 8 pixels.
// The range begins at push.first_triangle and has push.p0 triangles. push.p1 is its number; its draw has five
// words of arguments.
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = SLOT_INDICES) readonly buffer Indices { uint indices[]; };
layout(std430, set = 0, binding = SLOT_POSITIONS) readonly buffer Positions { float positions[]; };
layout(std430, set = 0, binding = SLOT_STATE_FRONT) writeonly buffer Touching { uint touching[]; };
layout(std430, set = 0, binding = SLOT_STATE_GROUP) writeonly buffer TouchingIndices { uint touching_indices[]; };
layout(std430, set = 0, binding = SLOT_STATE_BACK) buffer Arguments { uint arguments[]; };

const int kMostTiles = 1024;  // triangles with larger bounds are always taken
const float kSlack = 1.0;     // pixels; more than the rounding of rasterisation and the offset of samples

vec4 clip_of(uint vertex) {
  return frame.clip_from_world *
         vec4(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u], 1.0);
}

vec2 pixel_of(vec4 clip) {
  const vec2 whole = (clip.xy / clip.w * 0.5 + 0.5) * image_size();
  return whole - vec2(0.0, float(frame.first_row));
}

// Returns whether any tile between `low` and `high` is marked, in the copy of the band that begins at `row`.
bool any_marked(vec2 low, vec2 high, float row) {
  const ivec2 tiles = ivec2(tiles_of_image());
  const ivec2 first = ivec2(low + vec2(0.0, row)) / 8;
  const ivec2 last = min(ivec2(high + vec2(0.0, row)) / 8, tiles - 1);
  if ((last.x - first.x + 1) * (last.y - first.y + 1) > kMostTiles) return true;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      if (is_marked_tile(uint(y * tiles.x + x))) return true;
    }
  }
  return false;
}

bool touches(vec4 a, vec4 b, vec4 c) {
  if (min(a.w, min(b.w, c.w)) <= 0.0) return true;  // reaches behind the eye, so it may be anywhere
  const vec2 pa = pixel_of(a);
  const vec2 pb = pixel_of(b);
  const vec2 pc = pixel_of(c);
  const vec2 low = min(pa, min(pb, pc)) - kSlack;
  const vec2 high = max(pa, max(pb, pc)) + kSlack;
  const vec2 band = vec2(float(frame.size.x), float(rows_of_band()));
  if (any(lessThan(high, vec2(0.0))) || any(greaterThan(low, band))) return false;
  for (uint s = 0u; s < frame.samples; ++s) {
    if (any_marked(max(low, vec2(0.0)), min(high, band), float(s) * band.y)) return true;
  }
  return false;
}

void main() {
  const uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i >= push.p0) return;
  const uint triangle = push.first_triangle + i;
  const uvec3 corners = uvec3(indices[3u * triangle], indices[3u * triangle + 1u], indices[3u * triangle + 2u]);
  if (!touches(clip_of(corners.x), clip_of(corners.y), clip_of(corners.z))) return;
  const uint place = push.first_triangle + atomicAdd(arguments[5u * push.p1], 3u) / 3u;
  touching[place] = triangle;
  touching_indices[3u * place] = corners.x;
  touching_indices[3u * place + 1u] = corners.y;
  touching_indices[3u * place + 2u] = corners.z;
}
