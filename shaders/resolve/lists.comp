#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "resolve/storage.glsl"
#include "resolve/effects.glsl"

// Sorting networks over the arrays z and node, by z: Batcher's odd-even merge sort. It is written out so that
// all indices are constants and the arrays stay in registers. Based on: Batcher, "Sorting Networks and Their
// Applications", AFIPS 1968.
#define SORT_PAIR(i, j) { \
    const bool swapped = z[j] < z[i]; \
    const float zi = z[i]; const uint node_i = node[i]; \
    z[i] = swapped ? z[j] : zi; node[i] = swapped ? node[j] : node_i; \
    z[j] = swapped ? zi : z[j]; node[j] = swapped ? node_i : node[j]; }
#define SORT_4 \
  SORT_PAIR(0, 1) SORT_PAIR(2, 3) SORT_PAIR(0, 2) SORT_PAIR(1, 3) SORT_PAIR(1, 2)
#define SORT_8 \
  SORT_PAIR(0, 1) SORT_PAIR(2, 3) SORT_PAIR(4, 5) SORT_PAIR(6, 7) SORT_PAIR(0, 2) SORT_PAIR(1, 3) SORT_PAIR(4, 6) \
  SORT_PAIR(5, 7) SORT_PAIR(1, 2) SORT_PAIR(5, 6) SORT_PAIR(0, 4) SORT_PAIR(1, 5) SORT_PAIR(2, 6) SORT_PAIR(3, 7) \
  SORT_PAIR(2, 4) SORT_PAIR(3, 5) SORT_PAIR(1, 2) SORT_PAIR(3, 4) SORT_PAIR(5, 6)
#define SORT_16 \
  SORT_PAIR(0, 1) SORT_PAIR(2, 3) SORT_PAIR(4, 5) SORT_PAIR(6, 7) SORT_PAIR(8, 9) SORT_PAIR(10, 11) \
  SORT_PAIR(12, 13) SORT_PAIR(14, 15) SORT_PAIR(0, 2) SORT_PAIR(1, 3) SORT_PAIR(4, 6) SORT_PAIR(5, 7) \
  SORT_PAIR(8, 10) SORT_PAIR(9, 11) SORT_PAIR(12, 14) SORT_PAIR(13, 15) SORT_PAIR(1, 2) SORT_PAIR(5, 6) \
  SORT_PAIR(9, 10) SORT_PAIR(13, 14) SORT_PAIR(0, 4) SORT_PAIR(1, 5) SORT_PAIR(2, 6) SORT_PAIR(3, 7) \
  SORT_PAIR(8, 12) SORT_PAIR(9, 13) SORT_PAIR(10, 14) SORT_PAIR(11, 15) SORT_PAIR(2, 4) SORT_PAIR(3, 5) \
  SORT_PAIR(10, 12) SORT_PAIR(11, 13) SORT_PAIR(1, 2) SORT_PAIR(3, 4) SORT_PAIR(5, 6) SORT_PAIR(9, 10) \
  SORT_PAIR(11, 12) SORT_PAIR(13, 14) SORT_PAIR(0, 8) SORT_PAIR(1, 9) SORT_PAIR(2, 10) SORT_PAIR(3, 11) \
  SORT_PAIR(4, 12) SORT_PAIR(5, 13) SORT_PAIR(6, 14) SORT_PAIR(7, 15) SORT_PAIR(4, 8) SORT_PAIR(5, 9) \
  SORT_PAIR(6, 10) SORT_PAIR(7, 11) SORT_PAIR(2, 4) SORT_PAIR(3, 5) SORT_PAIR(6, 8) SORT_PAIR(7, 9) \
  SORT_PAIR(10, 12) SORT_PAIR(11, 13) SORT_PAIR(1, 2) SORT_PAIR(3, 4) SORT_PAIR(5, 6) SORT_PAIR(7, 8) \
  SORT_PAIR(9, 10) SORT_PAIR(11, 12) SORT_PAIR(13, 14)

// Inserts (carried_z, carried_id, carried_color) into the arrays z, id and color, which hold the 32 smallest
// so far. What falls out at the end is dropped.
#define CARRY(i) { \
    const bool here = before(carried_z, carried_id, z[i], id[i]); \
    const float zi = z[i]; const uint idi = id[i]; const uint ci = color[i]; \
    z[i] = here ? carried_z : zi; id[i] = here ? carried_id : idi; color[i] = here ? carried_color : ci; \
    carried_z = here ? zi : carried_z; carried_id = here ? idi : carried_id; carried_color = here ? ci : carried_color; }
#define CARRY_8(i) CARRY(i) CARRY(i + 1) CARRY(i + 2) CARRY(i + 3) CARRY(i + 4) CARRY(i + 5) CARRY(i + 6) CARRY(i + 7)
#define CARRY_32 CARRY_8(0) CARRY_8(8) CARRY_8(16) CARRY_8(24)

#include "resolve/tally.glsl"
#include "resolve/tiles.glsl"
// Sorts the fragments of a pixel by (z, id) and folds them, with one workgroup per tile and one invocation
// per pixel. It is compiled for each class of tiles. Lists of at most ROOM fragments are sorted by a network
// in registers. RUNS of 16 are sorted by the same network and merged. LONG lists give their nearest 32
// fragments at a time, each time those behind the last. PLAIN is the usual insertion sort of a local array of
// ROOM fragments, for comparison, whatever the length is.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
// Bits of kVariant. Value 1: nothing is counted, so a pixel is finished as soon as nothing behind can be
// seen. Value 2: pixels without fragments stay as they are.
const bool kCounts = (kVariant & 1u) == 0u;
const bool kRepairs = (kVariant & 2u) != 0u;
State state;
uint folded = 0u;
uint coplanar = 0u;
uint run = 0u;  // number of further fragments at the depth of the last one
float last_z = -1.0;
uint last_id = 0u;
bool done = false;

void fold(uint pixel, float fz, uint fid, uint fcolor) {
  if (kCounts) {
    run = fz == last_z ? run + 1u : 1u;
    coplanar += run == 2u ? 2u : run > 2u ? 1u : 0u;
  }
  last_z = fz;
  last_id = fid;
  ++folded;
  if (!done) effect_step(state, pixel, Fragment(fz, fid, fcolor));
  done = done || effect_is_done(state);
}

bool stops() { return done && !kCounts; }

#define ROOM_ARRAYS float z[ROOM]; uint id[ROOM]; uint color[ROOM];
#define CLEAR_ROOM for (uint i = 0u; i < ROOM; ++i) { z[i] = 2.0; id[i] = kNone; color[i] = 0u; }

#if defined(LONG)
// A driver may end all loops of an invocation after a number of turns (65,535 on lavapipe). push.p0 is the
// number of allowed turns. The fragments that are not reached are the farthest, and they are counted.
void fold_bucket(uint pixel, uint bucket) {
  ROOM_ARRAYS
  const uint count = stored_in(pixel, bucket);
  uint turns = 2u * count;
  uint left = count;
  last_z = -1.0;
  while (left > 0u) {
    if (turns + count + 2u * ROOM > push.p0) {
      atomicAdd(counters.overflowed, left);
      return;
    }
    turns += count + 2u * ROOM;
    const float from_z = last_z;
    const uint from_id = last_id;
    CLEAR_ROOM
    Cursor cursor = first_of(pixel, bucket);
    Fragment f;
    while (next(cursor, f)) {
      if (!before(from_z, from_id, f.z, f.id) || !before(f.z, f.id, z[ROOM - 1], id[ROOM - 1])) continue;
      float carried_z = f.z;
      uint carried_id = f.id;
      uint carried_color = f.color;
      CARRY_32
    }
    if (stops()) return;
    for (uint i = 0u; i < ROOM && left > 0u; ++i) {
      fold(pixel, z[i], id[i], color[i]);
      --left;
    }
  }
}
#elif defined(PLAIN)
void fold_bucket(uint pixel, uint bucket) {
  ROOM_ARRAYS
  uint count = 0u;
  Cursor cursor = first_of(pixel, bucket);
  Fragment f;
  while (next(cursor, f) && count < ROOM) {
    uint place = count++;
    for (; place > 0u && before(f.z, f.id, z[place - 1u], id[place - 1u]); --place) {
      z[place] = z[place - 1u];
      id[place] = id[place - 1u];
      color[place] = color[place - 1u];
    }
    z[place] = f.z;
    id[place] = f.id;
    color[place] = f.color;
  }
  for (uint i = 0u; i < count && !stops(); ++i) fold(pixel, z[i], id[i], color[i]);
}
#else
// Only depths and nodes are sorted. Ids are read for equal depths and when a fragment is folded, colours only
// then.
uvec2 sorted[RUNS * ROOM];  // depth, node
float nearest[RUNS];        // depth of the first fragment left in each run
uint place[RUNS];

#define LOAD(i) if (next_depth(cursor, depth, at)) { z[i] = depth; node[i] = at; }
#define LOAD_4(i) LOAD(i) LOAD(i + 1) LOAD(i + 2) LOAD(i + 3)
#define STORE(i) sorted[first + i] = uvec2(floatBitsToUint(z[i]), node[i]);
#define STORE_4(i) STORE(i) STORE(i + 1) STORE(i + 2) STORE(i + 3)
const float kBehindAll = 2.0;

void sort_run(uint run, inout Cursor cursor) {
  float z[ROOM];
  uint node[ROOM];
  for (uint i = 0u; i < ROOM; ++i) {
    z[i] = kBehindAll;
    node[i] = kNone;
  }
  float depth;
  uint at;
  const uint first = ROOM * run;
#if ROOM == 4
  LOAD_4(0) SORT_4 STORE_4(0)
#elif ROOM == 8
  LOAD_4(0) LOAD_4(4) SORT_8 STORE_4(0) STORE_4(4)
#else
  LOAD_4(0) LOAD_4(4) LOAD_4(8) LOAD_4(12) SORT_16 STORE_4(0) STORE_4(4) STORE_4(8) STORE_4(12)
#endif
  nearest[run] = z[0];
  place[run] = first;
}

// Returns the depth of the fragment after `at` in its run.
float depth_behind(uint at) { return at % ROOM == ROOM - 1u ? kBehindAll : uintBitsToFloat(sorted[at + 1u].x); }

void take(uint run, float behind) {
  nearest[run] = behind;
  ++place[run];
}

// Folds fragments at one depth, which are at the heads of some runs, by their ids. Returns how many there
// are.
uint fold_coplanar(uint pixel, uint runs, float z) {
  uint folded_id = 0u;
  uint group = 0u;
  for (;; ++group) {
    Fragment smallest = Fragment(z, kNone, 0u);
    for (uint run = 0u; run < runs; ++run) {
      float head = nearest[run];
      for (uint at = place[run]; head == z; ++at) {
        const Fragment f = fragment_at(sorted[at].y, z);
        if (f.id > folded_id && f.id < smallest.id) smallest = f;
        head = depth_behind(at);
      }
    }
    if (smallest.id == kNone) break;
    fold(pixel, z, smallest.id, smallest.color);
    folded_id = smallest.id;
  }
  for (uint run = 0u; run < runs; ++run) {
    while (nearest[run] == z) take(run, depth_behind(place[run]));
  }
  return group;
}

void fold_bucket(uint pixel, uint bucket) {
  const uint count = min(stored_in(pixel, bucket), RUNS * ROOM);
  const uint runs = (count + ROOM - 1u) / ROOM;
  Cursor cursor = first_of(pixel, bucket);
  for (uint run = 0u; run < runs; ++run) sort_run(run, cursor);
  for (uint left = count; left > 0u && !stops();) {
    uint run = 0u;
    bool tie = false;
    for (uint other = 1u; other < runs; ++other) {
      tie = nearest[other] == nearest[run] || (tie && nearest[other] > nearest[run]);
      if (nearest[other] < nearest[run]) run = other;
    }
    const float z = nearest[run];
    const float behind = depth_behind(place[run]);
    if (tie || behind == z) {
      left -= fold_coplanar(pixel, runs, z);
      continue;
    }
    const Fragment f = fragment_at(sorted[place[run]].y, z);
    fold(pixel, f.z, f.id, f.color);
    take(run, behind);
    --left;
  }
}
#endif

void main() {
  begin_tally();
  const uvec2 tiles_across = (frame.size + 7u) / 8u;
  const uint tile = tile_at(push.p1, gl_WorkGroupID.x, tiles_across.x * tiles_across.y);
  const uvec2 pixel = uvec2(tile % tiles_across.x, tile / tiles_across.x) * 8u + gl_LocalInvocationID.xy;
  if (all(lessThan(pixel, frame.size))) {
    const uint index = pixel_index(pixel);
    state = effect_init();
    for (uint bucket = 0u; bucket < bucket_count() && !stops(); ++bucket) fold_bucket(index, bucket);
    if (!kRepairs || folded > 0u) final_colors[index] = effect_finish(state, index);
    tally(folded, coplanar, true, false);
  }
  end_tally();
}
