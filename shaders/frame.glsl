// What all shaders share: the data of the frame, the slots of the one descriptor set, and the definition of a
// fragment.
//
// A fragment is (z, id, colour). `id` is 2 * (triangle + 1) + (1 if its back is seen). It is unique in a
// frame, and 0 means no fragment. Fragments are ordered by (z, id) everywhere. Depth is the 32-bit float
// gl_FragCoord.z; the bits of depths in 0..1 compare as integers.
#ifndef FRAME_GLSL
#define FRAME_GLSL
#extension GL_EXT_samplerless_texture_functions : require

// Slots, with the names of src/render/device/recorder.h.
#define SLOT_FRAME 0
#define SLOT_TRIANGLES 1
#define SLOT_SURFACES 2
#define SLOT_COUNTERS 3
#define SLOT_FINAL_COLORS 4
#define SLOT_STATE_FRONT 5
#define SLOT_STATE_GROUP 6
#define SLOT_DUMP 7
#define SLOT_A 8
#define SLOT_B 9
#define SLOT_C 10
#define SLOT_D 11
#define SLOT_INDICES 12
#define SLOT_POSITIONS 13
#define SLOT_STATE_BACK 14
#define SLOT_STATE_BACK_GROUP 15
#define SLOT_OBJECTS 16
#define SLOT_E 17
#define SLOT_ATTRIBUTES 18
#define SLOT_TEXTURES 19
#define SLOT_IMAGE_0 20
#define SLOT_IMAGE_1 21
#define SLOT_IMAGE_2 22
#define SLOT_OPAQUE 23

layout(constant_id = 0) const uint kEffect = 0u;
// Constants 1 and 2 belong to the technique.
layout(constant_id = 1) const uint kK = 8u;
layout(constant_id = 2) const uint kVariant = 0u;
// Tests that the fragments of the scene and pass need (src/render/frame.h).
layout(constant_id = 4) const uint kFeatures = 0u;
const uint kBehindOpaque = 1u;
const uint kColored = 2u;
const uint kCutOut = 4u;
bool has_feature(uint feature) { return (kFeatures & feature) != 0u; }

layout(push_constant) uniform Push {
  uint first_triangle;  // of this draw
  uint round;           // of a technique that works in rounds
  uint p0, p1, p2, p3;
} push;

layout(std430, set = 0, binding = SLOT_FRAME) readonly buffer Frame {
  mat4 clip_from_world;
  vec4 eye;         // w = 1: perspective; 0: orthographic
  vec4 to_viewer;   // orthographic: the direction to the viewer
  vec4 fill_light;  // direction to the light
  vec4 background;  // linear
  vec4 planes;      // near, far, 1 / near, 1 / far
  uvec2 size;       // samples of the image, or of the band that is drawn
  uint objects;
  uint capacity;    // nodes of the fragment pool
  vec4 line;        // wireframe: colour, half width in pixels
  uint first_row;   // of the band
  uint csg;         // 0: union, 1: intersection, 2: difference
  uint samples;     // per pixel: `size` has one copy of the band for each, below each other (samples.glsl)
} frame;

struct Fragment {
  float z;
  uint id;
  uint color;  // pack_color()
};

const uint kNone = 0xFFFFFFFFu;

uint pixel_index(uvec2 pixel) { return pixel.y * frame.size.x + pixel.x; }
uint pixel_count() { return frame.size.x * frame.size.y; }
bool is_back(uint id) { return (id & 1u) != 0u; }
uint triangle_of(uint id) { return (id >> 1) - 1u; }

// Packs a linear colour up to 2 in gamma 2, and alpha unchanged, with 8 bits each.
uint pack_color(vec4 c) { return packUnorm4x8(vec4(sqrt(clamp(c.rgb * 0.5, 0.0, 1.0)), c.a)); }
vec4 unpack_color(uint packed) {
  const vec4 c = unpackUnorm4x8(packed);
  return vec4(c.rgb * c.rgb * 2.0, c.a);
}

// Returns whether (z, id) comes before (other_z, other_id).
bool before(float z, uint id, float other_z, uint other_id) {
  return z < other_z || (z == other_z && id < other_id);
}

// Returns the distance along the viewing direction that belongs to a depth.
float view_distance(float z) {
  if (frame.eye.w != 0.0) return 1.0 / mix(frame.planes.z, frame.planes.w, z);
  return mix(frame.planes.x, frame.planes.y, z);
}
#endif
