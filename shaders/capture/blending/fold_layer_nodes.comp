#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/opaque.glsl"
#include "capture/blending/layer_nodes.glsl"
// Folds the kK nodes of every pixel, which are in order already, over the background. A layer of the image
// has four words, a node three.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
layout(set = 0, binding = SLOT_IMAGE_0) uniform utexture2DArray layers;
uint word_of(uvec2 pixel, uint i) { return texelFetch(layers, ivec3(pixel, i / 4u), 0)[i % 4u]; }
void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(at, frame.size))) return;
  vec4 seen = vec4(0.0, 0.0, 0.0, 1.0);
  for (uint i = 0u; i < kK; ++i) {
    const uvec3 node = uvec3(word_of(at, 3u * i), word_of(at, 3u * i + 1u), word_of(at, 3u * i + 2u));
    if (node.x == kNone) break;
    seen = layer_over(seen, node_layer(node));
  }
  const uint pixel = pixel_index(at);
  final_colors[pixel] = vec4(seen.rgb + seen.a * background_of(pixel), 1.0 - seen.a);
}
