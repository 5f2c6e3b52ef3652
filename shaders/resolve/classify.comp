#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "resolve/storage.glsl"
#include "resolve/tiles.glsl"
// Sorts tiles into classes by their longest list: at most 4, 8, 16 or 128 fragments, or more. Each class has
// its own sorting kernel. Also counts the pixels with fragments, and the largest number of fragments of a
// pixel.
layout(local_size_x = 8, local_size_y = 8) in;
#include "resolve/marked_tiles.glsl"
// With bit 1 of kVariant (value 2, lists.comp) there is a workgroup for each marked tile, otherwise for every
// tile.
const bool kRepairs = (kVariant & 2u) != 0u;
shared uint deepest_list, deepest_pixel, covered_pixels;
void main() {
  const uvec2 tile = kRepairs ? marked_tile(gl_WorkGroupID.x) : gl_WorkGroupID.xy;
  const uvec2 pixel = 8u * tile + gl_LocalInvocationID.xy;
  if (gl_LocalInvocationIndex == 0u) {
    deepest_list = 0u;
    deepest_pixel = 0u;
    covered_pixels = 0u;
  }
  barrier();
  if (all(lessThan(pixel, frame.size))) {
    const uint index = pixel_index(pixel);
    uint longest = 0u;
    uint sum = 0u;
    for (uint bucket = 0u; bucket < bucket_count(); ++bucket) {
      const uint count = stored_in(index, bucket);
      longest = max(longest, count);
      sum += count;
    }
    if (sum > 0u) {
      atomicMax(deepest_list, longest);
      atomicMax(deepest_pixel, sum);
      atomicAdd(covered_pixels, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  atomicMax(counters.deepest, deepest_pixel);
  atomicAdd(counters.covered, covered_pixels);
  put_tile(class_of(deepest_list), tile.y * tiles_of_image().x + tile.x, tile_count());
}
