// A node of multi-layer alpha blending: depth bits, then premultiplied colour and transmittance of one or
// more layers as half floats. An empty node has kNone in place of the depth.
#ifndef LAYER_NODES_GLSL
#define LAYER_NODES_GLSL
uvec3 layer_node(uint depth, vec4 layer) { return uvec3(depth, packHalf2x16(layer.rg), packHalf2x16(layer.ba)); }
vec4 node_layer(uvec3 node) { return vec4(unpackHalf2x16(node.y), unpackHalf2x16(node.z)); }
vec4 layer_over(vec4 front, vec4 behind) { return vec4(front.rgb + front.a * behind.rgb, front.a * behind.a); }
#endif
