// The state of a fold over a pixel's fragments; what its members mean is up to the effect.
#ifndef STATE_GLSL
#define STATE_GLSL
struct State {
  vec4 color;
  uvec4 word;
};
layout(std430, set = 0, binding = SLOT_OBJECTS) readonly buffer Objects { uint objects[]; };
uint object_of(uint id) { return objects[triangle_of(id)]; }
#endif
