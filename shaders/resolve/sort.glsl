// Sorting networks over the arrays z and node, by z: Batcher's odd-even merge sort, written out so that all indices are
// constants and the arrays live in registers. Batcher, "Sorting Networks and Their Applications", AFIPS 1968.
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

// Of the arrays z, id and color: insert (carried_z, carried_id, carried_color) into the 32 smallest so far; what falls out at the end is lost.
#define CARRY(i) { \
    const bool here = before(carried_z, carried_id, z[i], id[i]); \
    const float zi = z[i]; const uint idi = id[i]; const uint ci = color[i]; \
    z[i] = here ? carried_z : zi; id[i] = here ? carried_id : idi; color[i] = here ? carried_color : ci; \
    carried_z = here ? zi : carried_z; carried_id = here ? idi : carried_id; carried_color = here ? ci : carried_color; }
#define CARRY_8(i) CARRY(i) CARRY(i + 1) CARRY(i + 2) CARRY(i + 3) CARRY(i + 4) CARRY(i + 5) CARRY(i + 6) CARRY(i + 7)
#define CARRY_32 CARRY_8(0) CARRY_8(8) CARRY_8(16) CARRY_8(24)
