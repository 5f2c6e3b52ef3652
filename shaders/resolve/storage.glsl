// Reads the fragments of a pixel where a technique stored them: RANGES (S-buffer, with push.p3 nodes), LISTS
// (linked lists, possibly in buckets), ARRAYS (of fixed size) or LAYERS (of an image). A Cursor visits them
// in no particular order. next() returns whole fragments. next_depth() returns a depth and the node from
// which fragment_at() reads id and colour.
#if defined(RANGES)
layout(std430, set = 0, binding = SLOT_A) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Ends { uint ends[]; };
layout(std430, set = 0, binding = SLOT_C) readonly buffer Nodes { uint nodes[]; };
uint stored_begin(uint pixel) { return min(ends[pixel] - counts[pixel], push.p3); }
uint stored_count(uint pixel) { return min(ends[pixel], push.p3) - stored_begin(pixel); }
uint depth_words() { return push.p3; }
#elif defined(ARRAYS)
layout(std430, set = 0, binding = SLOT_A) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_C) readonly buffer Nodes { uint nodes[]; };
uint stored_begin(uint pixel) { return pixel * kK; }
uint stored_count(uint pixel) { return min(counts[pixel], kK); }
uint depth_words() { return kK * pixel_count(); }
#elif defined(LAYERS)
layout(set = 0, binding = SLOT_IMAGE_0) uniform utexture2DArray node_layers;
uvec4 layer_node(uint pixel, uint layer) {
  return texelFetch(node_layers, ivec3(pixel % frame.size.x, pixel / frame.size.x, layer), 0);
}
#else
layout(std430, set = 0, binding = SLOT_A) readonly buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = SLOT_C) readonly buffer Nodes { uvec4 nodes[]; };
#endif

#if defined(LISTS)
struct Cursor {
  uint node;
};
uint bucket_head(uint pixel, uint bucket) { return heads[kK * pixel + bucket]; }
Cursor first_of(uint pixel, uint bucket) { return Cursor(bucket_head(pixel, bucket)); }
bool next(inout Cursor cursor, out Fragment f) {
  if (cursor.node == kNone) return false;
  const uvec4 node = nodes[cursor.node];
  f = Fragment(uintBitsToFloat(node.x), node.y, node.z);
  cursor.node = node.w;
  return true;
}
bool next_depth(inout Cursor cursor, out float z, out uint node) {
  if (cursor.node == kNone) return false;
  node = cursor.node;
  z = uintBitsToFloat(nodes[node].x);
  cursor.node = nodes[node].w;
  return true;
}
Fragment fragment_at(uint node, float z) { return Fragment(z, nodes[node].y, nodes[node].z); }
uint stored_in(uint pixel, uint bucket) {
  uint count = 0u;
  for (uint node = bucket_head(pixel, bucket); node != kNone; node = nodes[node].w) ++count;
  return count;
}
uint bucket_count() { return kK; }
#elif defined(LAYERS)
struct Cursor {
  uint pixel, layer;
};
Cursor first_of(uint pixel, uint bucket) { return Cursor(pixel, 0u); }
bool next(inout Cursor cursor, out Fragment f) {
  if (cursor.layer == kK) return false;
  const uvec4 node = layer_node(cursor.pixel, cursor.layer);
  if (node.y == 0u) return false;
  f = Fragment(uintBitsToFloat(node.x), node.y, node.z);
  ++cursor.layer;
  return true;
}
// The node has the pixel and the layer in one number.
bool next_depth(inout Cursor cursor, out float z, out uint node) {
  Fragment f;
  node = cursor.pixel * kK + cursor.layer;
  if (!next(cursor, f)) return false;
  z = f.z;
  return true;
}
Fragment fragment_at(uint node, float z) {
  const uvec4 found = layer_node(node / kK, node % kK);
  return Fragment(z, found.y, found.z);
}
uint stored_in(uint pixel, uint bucket) {
  uint count = 0u;
  while (count < kK && layer_node(pixel, count).y != 0u) ++count;
  return count;
}
uint bucket_count() { return 1u; }
#else
struct Cursor {
  uint node, end;
};
Cursor first_of(uint pixel, uint bucket) {
  const uint begin = stored_begin(pixel);
  return Cursor(begin, begin + stored_count(pixel));
}
bool next_depth(inout Cursor cursor, out float z, out uint node) {
  if (cursor.node == cursor.end) return false;
  node = cursor.node++;
  z = uintBitsToFloat(nodes[node]);
  return true;
}
Fragment fragment_at(uint node, float z) {
  const uint word = depth_words() + 2u * node;
  return Fragment(z, nodes[word], nodes[word + 1u]);
}
bool next(inout Cursor cursor, out Fragment f) {
  float z;
  uint node;
  if (!next_depth(cursor, z, node)) return false;
  f = fragment_at(node, z);
  return true;
}
uint stored_in(uint pixel, uint bucket) { return stored_count(pixel); }
uint bucket_count() { return 1u; }
#endif
