#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/places.glsl"
// Sorts slots that were filled in no order (max_first.frag): nearest first, empty ones last.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_A) buffer Pool { uint words[]; };
#include "capture/k_buffers/max_heap.glsl"
const uint kShort = 16u;

void sort_few(uint first, uint count) {
  uvec2 sorted[kShort];
  for (uint i = 0u; i < count; ++i) {
    const uvec2 key = key_at(first + i);
    uint at = i;
    for (; at > 0u && is_behind(sorted[at - 1u], key); --at) sorted[at] = sorted[at - 1u];
    sorted[at] = key;
  }
  for (uint i = 0u; i < count; ++i) put_key(first + i, sorted[i]);
}

// Repeatedly moves the farthest key of the heap behind the rest of the heap.
void sort_heap(uint first, uint count) {
  for (uint left = count - 1u; left > 0u; --left) {
    const uvec2 farthest = key_at(first);
    const uvec2 last = key_at(first + left);
    put_key(first, sift_down(first, left, 0u, last));
    put_key(first + left, farthest);
  }
}

void make_heap(uint first, uint count) {
  for (uint at = count / 2u; at > 0u; --at)
    put_key(first + at - 1u, sift_down(first, count, at - 1u, key_at(first + at - 1u)));
}

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const Place place = place_of(pixel_index(gl_GlobalInvocationID.xy));
  if (place.keys == 0u) return;
  if (place.keys <= kShort) {
    sort_few(place.first, place.keys);
    return;
  }
  if (place.tail == 0u || place.keys < kK) make_heap(place.first, place.keys);
  sort_heap(place.first, place.keys);
}
