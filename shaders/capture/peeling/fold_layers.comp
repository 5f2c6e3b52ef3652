#version 460
#extension GL_GOOGLE_include_directive : require
#if defined(CHAINS)
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#endif
#include "frame.glsl"
#include "counters.glsl"
#include "resolve/effects.glsl"
#include "capture/peeling/layers.glsl"

// Reads what a round delivered at an end of a pixel, in order (layers.glsl). next_delivered() has given
// `count` fragments so far, the last of them with the id `last`. It gives the next one behind them or, at the
// far end, in front of them.
#if defined(IMAGE)
layout(set = 0, binding = SLOT_IMAGE_2) uniform utexture2D found;
bool next_delivered(uint end, ivec2 pixel, bool far, uint count, uint last, inout Fragment f) {
  if (count > 0u) return false;
  const uvec2 texel = texelFetch(found, pixel, 0).xy;
  f.id = texel.x;
  f.color = texel.y;
  return texel.x != 0u;
}
#elif defined(CHAINS)
bool next_delivered(uint end, ivec2 pixel, bool far, uint count, uint last, inout Fragment f) {
  if (count >= kK) return false;
  const uint64_t node = chains[kK * end + count];
  const uint id = uint(node >> 32);
  f.id = far ? ~id : id;
  f.color = uint(node);
  return node != kEmpty;
}
#elif defined(LISTS) || defined(ARRAYS)
// Groups at one depth are short, so the next fragment is searched for among all of them. A driver may end all
// loops of an invocation after a number of turns. push.p0 is the number of allowed turns, and fragments that
// are not reached are counted.
uint turns = 0u;
uint group_length = 0u;

#if defined(LISTS)
uint length_of(uint end) {
  uint count = 0u;
  for (uint node = heads[end]; node != kNone; node = nodes[3u * node + 2u]) ++count;
  return count;
}
#else
uint length_of(uint end) { return min(counts[end], kK); }
#endif

bool next_delivered(uint end, ivec2 pixel, bool far, uint count, uint last, inout Fragment f) {
  if (count == 0u) {
    group_length = length_of(end);
    turns += group_length;
  }
  turns += group_length + 1u;
  if (turns > push.p0) return false;
  f.id = far ? 0u : kNone;
#if defined(LISTS)
  for (uint at = heads[end]; at != kNone; at = nodes[3u * at + 2u]) {
    const uvec2 node = uvec2(nodes[3u * at], nodes[3u * at + 1u]);
#else
  for (uint at = 0u; at < min(counts[end], kK); ++at) {
    const uvec2 node = nodes[kK * end + at];
#endif
    const bool is_next = far ? (count == 0u || node.x < last) && node.x > f.id
                             : (count == 0u || node.x > last) && node.x < f.id;
    if (!is_next) continue;
    f.id = node.x;
    f.color = node.y;
  }
  return f.id != (far ? 0u : kNone);
}
#endif

#include "resolve/tally.glsl"
// Runs after a round of peeling. Folds what it delivered into the state of each pixel, empties its storage
// for the next round and, with SEARCH, moves on to the layers that it found.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_STATE_FRONT) buffer FrontStates { State front_states[]; };
#if SIDES == 2
layout(std430, set = 0, binding = SLOT_STATE_BACK) buffer BackStates { State back_states[]; };
#endif
#if defined(PAIRS)
// Effect states of layers that take several rounds. At the near end they hold the largest ids so far, which
// lie behind those to come, at the far end the smallest ones.
layout(std430, set = 0, binding = SLOT_STATE_GROUP) buffer FrontGroups { State front_groups[]; };
#if SIDES == 2
layout(std430, set = 0, binding = SLOT_STATE_BACK_GROUP) buffer BackGroups { State back_groups[]; };
#endif
#endif
#if !defined(IMAGE)
// Numbers of coplanar fragments so far.
layout(std430, set = 0, binding = SLOT_D) buffer Coplanar { uint coplanar_before[]; };
#endif
#if !defined(SEARCH)
layout(set = 0, binding = SLOT_IMAGE_1) uniform texture2D layer;
#endif

uint captured = 0u;
uint coplanar = 0u;
uint overflowed = 0u;
const bool kFar = true;

void step_front(inout State s, uint pixel, Fragment f) {
  if (!effect_is_done(s)) effect_step(s, pixel, f);
}

// Returns whether the layer has more fragments, for another round.
#if defined(PAIRS)
void fold_front_pair(uint pixel, Fragment first, Fragment last, bool two, bool more) {
  State s = front_states[pixel];
  step_front(s, pixel, first);
  if (!effect_blends()) {
    if (two) effect_step(s, pixel, last);
  } else if (two) {
    State group = front_groups[pixel];
    effect_step_back(group, pixel, last);
    if (!more) effect_merge(s, group);
    front_groups[pixel] = more ? group : effect_init();
  } else {
    effect_merge(s, front_groups[pixel]);
    front_groups[pixel] = effect_init();
  }
  front_states[pixel] = s;
}

#if SIDES == 2
// Effects that do not blend get the smallest id of a layer last, as if the fragments came one by one from the
// far end. The state of the group keeps it until then.
void fold_back_pair(uint pixel, Fragment first, Fragment last, bool two, bool begins, bool more) {
  State s = back_states[pixel];
  State group = back_groups[pixel];
  if (effect_blends()) {
    effect_step_back(s, pixel, two ? last : first);
    if (two) effect_step(group, pixel, first);
    if (!more) {
      effect_merge(group, s);
      s = group;
      group = effect_init();
    }
  } else {
    if (two) effect_step_back(s, pixel, last);
    if (begins) group.word.xy = uvec2(first.id, first.color);
    else effect_step_back(s, pixel, first);
    if (!more) effect_step_back(s, pixel, Fragment(first.z, group.word.x, group.word.y));
  }
  back_states[pixel] = s;
  back_groups[pixel] = group;
}
#endif

bool fold(uint pixel, ivec2 at, uint end, bool far, float z) {
  const Pair pair = pairs[end];
  if (pair.count == 0u) return false;
  const bool begins = windows[end].x == 0u;
  const bool two = pair.count > 1u;
  const bool more = pair.count > 2u;
  const Fragment first = Fragment(z, ~pair.smallest_complement, pair.smallest_color);
  const Fragment last = Fragment(z, pair.largest, pair.largest_color);
#if SIDES == 2
  if (far) fold_back_pair(pixel, first, last, two, begins, more);
  else
#endif
  fold_front_pair(pixel, first, last, two, more);
  captured += two ? 2u : 1u;
  if (two || !begins) coplanar += two ? 2u : 1u;
  pairs[end] = Pair(0u, 0u, 0u, 0u, 0u);
  windows[end] = more ? uvec2(first.id, last.id) : uvec2(0u);
  return more;
}
#else
bool fold(uint pixel, ivec2 at, uint end, bool far, float z) {
  Fragment f = Fragment(z, 0u, 0u);
  uint count = 0u;
  bool any = next_delivered(end, at, far, count, 0u, f);
#if defined(LISTS) || defined(ARRAYS)
  if (group_length == 0u) return false;
#else
  if (!any) return false;
#endif
  State s = front_states[pixel];
#if SIDES == 2
  if (far) s = back_states[pixel];
#endif
  while (any) {
    if (far) effect_step_back(s, pixel, f);
    else step_front(s, pixel, f);
    ++count;
    any = next_delivered(end, at, far, count, f.id, f);
  }
#if SIDES == 2
  if (far) back_states[pixel] = s;
  else
#endif
  front_states[pixel] = s;
  captured += count;

  bool more = false;
  bool begins = true;
#if defined(CHAINS)
  if (resumes()) {
    begins = windows[end].x == 0u;
    more = windows[end].y != 0u;
    windows[end] = uvec2(more ? f.id : 0u, 0u);
  }
  for (uint i = 0u; i < count; ++i) chains[kK * end + i] = kEmpty;
#elif defined(LISTS)
  overflowed += group_length - count;
  heads[end] = kNone;
#elif defined(ARRAYS)
  overflowed += counts[end] - count;
  counts[end] = 0u;
#endif
  if (count > 1u || more || !begins) coplanar += count;
  return more;
}
#endif

// Returns whether another round may find something.
bool fold_pixel(uint pixel, ivec2 at) {
  if (push.round == 0u) {
    front_states[pixel] = effect_init();
#if SIDES == 2
    back_states[pixel] = effect_init();
#endif
#if defined(PAIRS)
    front_groups[pixel] = effect_init();
#if SIDES == 2
    back_groups[pixel] = effect_init();
#endif
#endif
  }
#if defined(SEARCH)
  uvec2 near = depths[near_end(pixel)];
  if (push.round == 0u) near.x = 0u;
  if (near.x != kNone) {
    const bool more = near.x != 0u && fold(pixel, at, near_end(pixel), !kFar, depth_of(near.x));
    if (!more) near.x = ~near.y;
    depths[near_end(pixel)] = uvec2(near.x, 0u);
  }
#if SIDES == 2
  uvec2 far = depths[far_end(pixel)];
  if (push.round == 0u) far.x = kNone;
  if (far.x != 0u) {
    const bool more = far.x != kNone && fold(pixel, at, far_end(pixel), kFar, depth_of(far.x));
    if (!more) far.x = far.y;
    // If both ends are in one layer, it belongs to the near end.
    if (far.x == near.x) far.x = 0u;
    depths[far_end(pixel)] = uvec2(far.x, 0u);
  }
  return near.x != kNone || far.x != 0u;
#else
  return near.x != kNone;
#endif
#else
  fold(pixel, at, near_end(pixel), !kFar, texelFetch(layer, at, 0).x);
  return captured > 0u;
#endif
}

void main() {
  begin_tally();
  if (all(lessThan(gl_GlobalInvocationID.xy, frame.size))) {
    const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
    const bool goes_on = fold_pixel(pixel, ivec2(gl_GlobalInvocationID.xy));
    bool new_pixel = true;
#if !defined(IMAGE)
    if (coplanar > 0u) {
      new_pixel = coplanar_before[pixel] == 0u;
      coplanar_before[pixel] += coplanar;
    }
#endif
    tally(captured, coplanar, new_pixel, goes_on);
    if (overflowed > 0u) atomicAdd(counters.overflowed, overflowed);
  }
  end_tally();
}
