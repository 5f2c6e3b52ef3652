/* pellucid/runtime/select.h - selects the draw order of a mesh for a camera.
 *
 * In: the fields of the PELLUCID_mesh_primitive_view_orders extension of a primitive, the world matrix of its
 * node and the camera. Out: the index of the order to draw. This is a single C99 file that also compiles as
 * C++. It needs only <stdint.h> and <math.h>, allocates nothing and has no mutable globals. You can copy it
 * into any renderer.
 *
 * Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 6, and for animations
 * Han, Sander, "Triangle Reordering for Efficient Rendering in Complex Scenes", JCGT 6(3), 2017, section 3.3.
 * Differs in: in addition to the (theta, phi) table of the paper there is a direct descent of the icosphere,
 * which needs no memory.
 *
 * Example:
 *
 *   PellucidOrders orders = {0};
 *   orders.cells = pellucid_cells_triangles;      orders.level = 2;
 *   orders.center[0] = ...;                       orders.radius = 1.94;
 *   orders.min_distance = 1.5;                    orders.max_distance = HUGE_VAL;   (in radii)
 *   orders.cell_orders = accessor_bytes;          orders.cell_order_bytes = 1;
 *   orders.fallback_order = PELLUCID_NO_ORDER;
 *   uint32_t order = pellucid_select_perspective(&orders, node_world_matrix, camera_position);
 *   if (order == PELLUCID_NO_ORDER) draw(primitive.indices); else draw(orders[order]);
 *
 * For orders of purpose "overdraw" while an animation plays (examples/select_animated.c):
 *
 *   PellucidKeyframes walk = {times, spheres, count, cell_orders, 1};     (accessors of one of `keyframes`)
 *   draw(orders[pellucid_select_animated(&orders, &walk, time, model_world_matrix, camera_position)]);
 *
 * THE NUMBERING (normative for the file format)
 *   The base vertices and faces are in the two tables below. Faces are counter-clockwise seen from outside.
 *   At level n + 1, triangle f with the corners c0 c1 c2 has the children
 *     4f + 0 = (c0,  m01, m20)      4f + 1 = (m01, c1,  m12)
 *     4f + 2 = (m20, m12, c2)       4f + 3 = (m12, m20, m01)
 *   where m01 = normalize(c0 + c1) and so on. Level n has 20 * 4^n triangles, 0 <= n <= 8.
 *   A direction nearer than 1e-12 to a border is on the border. It belongs to the touching cell with the
 *   lowest id. A direction of zeros, or with NaN or infinities, belongs to cell 0.
 *
 * Directions point from the centre of the bounding sphere to the camera. Matrices are column-major, as in
 * glTF. */
#ifndef PELLUCID_RUNTIME_SELECT_H
#define PELLUCID_RUNTIME_SELECT_H

#include <math.h>
#include <stdint.h>

#ifdef __cplusplus
#define PELLUCID_RUNTIME_CAST(type, value) static_cast<type>(value)
extern "C" {
#else
#define PELLUCID_RUNTIME_CAST(type, value) ((type)(value))
#endif

#define PELLUCID_MAX_LEVEL 8u
#define PELLUCID_BORDER 1e-12 /* radians; a direction nearer to a border is on it */

/* ------------------------------------------------------------------------------------- the icosahedron */

/* The vertices are (0, +-s, +-t) and its cyclic shifts, with s = sqrt((5 - sqrt 5) / 10) and
 * t = sqrt((5 + sqrt 5) / 10). */
#define PELLUCID_S 0.52573111211913360603
#define PELLUCID_T 0.85065080835203993218
static const double pellucid_base_vertices[12][3] = {
    {-PELLUCID_S, PELLUCID_T, 0},  {PELLUCID_S, PELLUCID_T, 0},   {-PELLUCID_S, -PELLUCID_T, 0},
    {PELLUCID_S, -PELLUCID_T, 0},  {0, -PELLUCID_S, PELLUCID_T},  {0, PELLUCID_S, PELLUCID_T},
    {0, -PELLUCID_S, -PELLUCID_T}, {0, PELLUCID_S, -PELLUCID_T},  {PELLUCID_T, 0, -PELLUCID_S},
    {PELLUCID_T, 0, PELLUCID_S},   {-PELLUCID_T, 0, -PELLUCID_S}, {-PELLUCID_T, 0, PELLUCID_S}};
static const uint8_t pellucid_base_faces[20][3] = {
    {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

/* Returns the number of triangles of a level. */
static inline uint32_t pellucid_triangle_count(uint32_t level) {
  return 20u << (2u * level);
}

static inline double pellucid_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void pellucid_cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Computes normalize(a + b). The result has the same bits for (b, a). */
static inline void pellucid_midpoint(const double a[3], const double b[3], double out[3]) {
  double scale;
  out[0] = a[0] + b[0];
  out[1] = a[1] + b[1];
  out[2] = a[2] + b[2];
  scale = 1.0 / sqrt(pellucid_dot(out, out));
  out[0] *= scale;
  out[1] *= scale;
  out[2] *= scale;
}

/* Computes the unit vector along a direction of any length and returns 1. Returns 0 and the zero vector if
 * the direction is zero, NaN or infinite. */
static inline int pellucid_normalize(const double direction[3], double out[3]) {
  double largest = fabs(direction[0]);
  double scale;
  int i;
  out[0] = out[1] = out[2] = 0;
  if (fabs(direction[1]) > largest) largest = fabs(direction[1]);
  if (fabs(direction[2]) > largest) largest = fabs(direction[2]);
  /* The comparisons above ignore NaN, but this sum is NaN as soon as one of the numbers is NaN or infinite.
   */
  if (!(largest > 0) ||
      !(direction[0] - direction[0] + direction[1] - direction[1] + direction[2] - direction[2] == 0))
    return 0;
  for (i = 0; i < 3; ++i) out[i] = direction[i] / largest;
  scale = 1.0 / sqrt(pellucid_dot(out, out));
  for (i = 0; i < 3; ++i) out[i] *= scale;
  return 1;
}

/* Writes the corners of a base face. */
static inline void pellucid_base_corners(uint32_t face, double corners[3][3]) {
  int k, i;
  for (k = 0; k < 3; ++k)
    for (i = 0; i < 3; ++i) corners[k][i] = pellucid_base_vertices[pellucid_base_faces[face][k]][i];
}

/* Computes the midpoints opposite to the corners: m12, m20, m01. */
static inline void pellucid_midpoints(double corners[3][3], double middles[3][3]) {
  pellucid_midpoint(corners[1], corners[2], middles[0]);
  pellucid_midpoint(corners[2], corners[0], middles[1]);
  pellucid_midpoint(corners[0], corners[1], middles[2]);
}

/* Replaces the corners of a triangle by those of its child 0..3. */
static inline void pellucid_enter_child(uint32_t child, double corners[3][3], double middles[3][3]) {
  uint32_t k;
  int i;
  for (k = 0; k < 3; ++k) {
    /* The child at corner c keeps corner c. Its corner k is the midpoint opposite to the third corner. */
    const double* from = middles[child == 3 ? k : 3 - child - k];
    if (k == child) continue;
    for (i = 0; i < 3; ++i) corners[k][i] = from[i];
  }
}

/* Computes the three unit corners of a triangle of `level`. */
static inline void pellucid_triangle_corners(uint32_t level, uint32_t triangle, double corners[3][3]) {
  uint32_t n;
  pellucid_base_corners(triangle >> (2u * level), corners);
  for (n = level; n-- > 0;) {
    double middles[3][3];
    pellucid_midpoints(corners, middles);
    pellucid_enter_child((triangle >> (2u * n)) & 3u, corners, middles);
  }
}

/* Returns the side of the great circle through a and b on which the unit vector `d` is: 1 for left (inside of
 * counter-clockwise triangles), -1 for right, and 0 for nearer than `border` radians. */
static inline int pellucid_side(const double a[3], const double b[3], const double d[3], double border) {
  double normal[3];
  double s;
  pellucid_cross(a, b, normal);
  s = pellucid_dot(normal, d);
  if (s * s <= border * border * pellucid_dot(normal, normal)) return 0;
  return s > 0 ? 1 : -1;
}

/* -------------------------------------------------------------------------------------------- descent */

/* Returns the base face of a unit direction: the face with the largest sum of dot products with its corners,
 * and the lowest id of several such faces. */
static inline uint32_t pellucid_base_face(const double d[3]) {
  /* Crossing a border by the angle e changes the difference between the sums of the two neighbours by 1.7013
   * e, where 1.7013 is the distance between their opposite corners. */
  const double tie = 1.7013 * PELLUCID_BORDER;
  double near[12], sums[20], best = -4;
  uint32_t v, f;
  for (v = 0; v < 12; ++v) near[v] = pellucid_dot(pellucid_base_vertices[v], d);
  for (f = 0; f < 20; ++f) {
    const uint8_t* c = pellucid_base_faces[f];
    sums[f] = near[c[0]] + near[c[1]] + near[c[2]];
    if (sums[f] > best) best = sums[f];
  }
  f = 0;
  while (f < 19 && sums[f] < best - tie) ++f;
  return f;
}

/* Returns the triangle of `level` that contains the unit direction d, and its corners. */
static inline uint32_t pellucid_descend(uint32_t level, const double d[3], double corners[3][3]) {
  uint32_t triangle = pellucid_base_face(d);
  uint32_t n;
  pellucid_base_corners(triangle, corners);
  for (n = 0; n < level; ++n) {
    double middles[3][3];
    uint32_t child = 3;
    pellucid_midpoints(corners, middles);
    /* A child at a corner is to the left of the line through its two midpoints. The middle child is to the
     * right of all three lines. */
    if (pellucid_side(middles[2], middles[1], d, PELLUCID_BORDER) >= 0)
      child = 0;
    else if (pellucid_side(middles[0], middles[2], d, PELLUCID_BORDER) >= 0)
      child = 1;
    else if (pellucid_side(middles[1], middles[0], d, PELLUCID_BORDER) >= 0)
      child = 2;
    pellucid_enter_child(child, corners, middles);
    triangle = 4u * triangle + child;
  }
  return triangle;
}

/* Returns the view triangle (S, T and R cells) of a direction of any length. Takes O(level), with three
 * square roots per level. */
static inline uint32_t pellucid_find_triangle(uint32_t level, const double direction[3]) {
  double d[3];
  double corners[3][3];
  if (!pellucid_normalize(direction, d)) return 0;
  return pellucid_descend(level, d, corners);
}

/* Returns the discrete viewpoint (P cells) of a direction of any length as 3 * triangle + corner, which is an
 * index into a table with one entry per corner of every triangle. All triangles are acute, so the nearest
 * vertex of the whole sphere is a corner of the triangle that contains the direction. */
static inline uint32_t pellucid_find_corner(uint32_t level, const double direction[3]) {
  double d[3];
  double corners[3][3];
  uint32_t triangle, best = 0, k;
  if (!pellucid_normalize(direction, d)) return 0;
  triangle = pellucid_descend(level, d, corners);
  for (k = 1; k < 3; ++k)
    if (pellucid_dot(corners[k], d) > pellucid_dot(corners[best], d)) best = k;
  return 3u * triangle + best;
}

/* ---------------------------------------------------------------------------------------------- table */

/* The table's data of a triangle: the inward unit normals of its edge planes, and its one-ring, which are the
 * triangles that share an edge or a corner with it. Unused entries contain the triangle itself. */
typedef struct PellucidTableCell {
  double planes[3][3];
  uint32_t ring[12];
} PellucidTableCell;

/* The table of section 6 of the paper: triangle ids by polar and azimuth angle. It gives the same results as
 * the descent, at the cost of two inverse trigonometric functions and one to thirteen containment tests. */
typedef struct PellucidTable {
  uint32_t level, theta_steps, phi_steps;
  PellucidTableCell* cells; /* pellucid_triangle_count(level) entries, provided by the caller */
  uint32_t* grid;           /* theta_steps * phi_steps entries, provided by the caller */
} PellucidTable;

#define PELLUCID_PI 3.14159265358979323846

static inline uint32_t pellucid_table_step(double position, uint32_t steps) {
  const double scaled = position * PELLUCID_RUNTIME_CAST(double, steps);
  if (!(scaled > 0)) return 0;
  return scaled < PELLUCID_RUNTIME_CAST(double, steps) ? PELLUCID_RUNTIME_CAST(uint32_t, scaled) : steps - 1;
}

static inline uint32_t pellucid_table_entry(const PellucidTable* table, const double d[3]) {
  const double z = d[2] < -1 ? -1 : (d[2] > 1 ? 1 : d[2]);
  const uint32_t row = pellucid_table_step(acos(z) / PELLUCID_PI, table->theta_steps);
  const uint32_t column = pellucid_table_step(atan2(d[1], d[0]) / (2 * PELLUCID_PI) + 0.5, table->phi_steps);
  return row * table->phi_steps + column;
}

/* Finds the triangles around the corners of `triangle` by testing points on a small circle around each
 * corner. */
static inline void pellucid_table_ring(uint32_t level, uint32_t triangle, double corners[3][3],
                                       uint32_t ring[12]) {
  uint32_t count = 0, k, probe, i;
  for (i = 0; i < 12; ++i) ring[i] = triangle;
  for (k = 0; k < 3; ++k) {
    double* corner = corners[k];
    double side[3], up[3], normal[3], radius;
    /* The radius is a third of an edge, along two tangents at the corner. */
    pellucid_cross(corner, corners[(k + 1) % 3], normal);
    radius = sqrt(pellucid_dot(normal, normal)) / 3;
    pellucid_normalize(normal, side);
    pellucid_cross(corner, side, up);
    for (probe = 0; probe < 24; ++probe) {
      const double angle = 2 * PELLUCID_PI * (PELLUCID_RUNTIME_CAST(double, probe) + 0.5) / 24;
      double d[3];
      uint32_t found, known = 0;
      for (i = 0; i < 3; ++i) d[i] = corner[i] + radius * (cos(angle) * side[i] + sin(angle) * up[i]);
      found = pellucid_find_triangle(level, d);
      if (found == triangle) continue;
      for (i = 0; i < count; ++i) known |= ring[i] == found ? 1u : 0u;
      if (!known && count < 12) ring[count++] = found;
    }
  }
}

/* Fills a table whose members (level, steps and memory) the caller has set. With a grid of about 4 * 2^level
 * by 8 * 2^level steps the first containment test mostly succeeds. The results are correct for any size. */
static inline void pellucid_table_build(const PellucidTable* table) {
  uint32_t t, row, column, k;
  for (t = 0; t < pellucid_triangle_count(table->level); ++t) {
    PellucidTableCell* cell = &table->cells[t];
    double corners[3][3];
    pellucid_triangle_corners(table->level, t, corners);
    for (k = 0; k < 3; ++k) {
      double normal[3];
      pellucid_cross(corners[k], corners[(k + 1) % 3], normal);
      pellucid_normalize(normal, cell->planes[k]);
    }
    pellucid_table_ring(table->level, t, corners, cell->ring);
  }
  for (row = 0; row < table->theta_steps; ++row) {
    for (column = 0; column < table->phi_steps; ++column) {
      const double theta = PELLUCID_PI * (PELLUCID_RUNTIME_CAST(double, row) + 0.5) / table->theta_steps;
      const double phi =
          2 * PELLUCID_PI * ((PELLUCID_RUNTIME_CAST(double, column) + 0.5) / table->phi_steps - 0.5);
      double d[3];
      d[0] = sin(theta) * cos(phi);
      d[1] = sin(theta) * sin(phi);
      d[2] = cos(theta);
      table->grid[row * table->phi_steps + column] = pellucid_find_triangle(table->level, d);
    }
  }
}

/* Returns whether the unit vector d is inside the cell and so far from its borders that no other cell can
 * contain it. */
static inline int pellucid_table_inside(const PellucidTableCell* cell, const double d[3]) {
  const double clear = 2 * PELLUCID_BORDER;
  return pellucid_dot(cell->planes[0], d) > clear && pellucid_dot(cell->planes[1], d) > clear &&
         pellucid_dot(cell->planes[2], d) > clear;
}

/* Returns the same triangle as pellucid_find_triangle(). Uses the descent for directions on a border, and for
 * those outside of the one-ring if the grid is coarse. */
static inline uint32_t pellucid_table_find(const PellucidTable* table, const double direction[3]) {
  double d[3];
  double corners[3][3];
  uint32_t candidate, i;
  if (!pellucid_normalize(direction, d)) return 0;
  candidate = table->grid[pellucid_table_entry(table, d)];
  if (pellucid_table_inside(&table->cells[candidate], d)) return candidate;
  for (i = 0; i < 12; ++i) {
    const uint32_t neighbor = table->cells[candidate].ring[i];
    if (pellucid_table_inside(&table->cells[neighbor], d)) return neighbor;
  }
  return pellucid_descend(table->level, d, corners);
}

/* ------------------------------------------------------------------------------- from camera to order */

/* The kind of view cells. */
typedef enum PellucidCells {
  pellucid_cells_triangles = 0, /* cell_orders has one entry per triangle (S, T, R) */
  pellucid_cells_corners = 1    /* cell_orders has three entries per triangle, one per corner (P) */
} PellucidCells;

/* Stands for primitive.indices instead of an order. */
#define PELLUCID_NO_ORDER 0xFFFFFFFFu

/* The extension of one primitive. Initialise all members to zero and set the known ones, as in the example
 * above. */
typedef struct PellucidOrders {
  PellucidCells cells;
  uint32_t level;
  double center[3]; /* of the bounding sphere, in the primitive's own space */
  double radius;
  double min_distance, max_distance; /* the valid range, in radii; HUGE_VAL: no limit */
  const void* cell_orders;           /* bytes of the accessor, little-endian, aligned to their size */
  uint32_t cell_order_bytes;         /* 1, 2 or 4 */
  uint32_t fallback_order;           /* outside of the valid range, or PELLUCID_NO_ORDER */
} PellucidOrders;

/* The position of a camera relative to the mesh. */
typedef struct PellucidView {
  double direction[3]; /* local space, from the centre to the camera, any length */
  double distance;     /* from the centre, in radii; HUGE_VAL for orthographic cameras */
  int valid;           /* 0 for a singular matrix, a camera at the centre, or NaN */
} PellucidView;

/* Computes out = inverse(upper left 3x3 of world) * v. `world` may mirror. Returns 0 if it is singular. */
static inline int pellucid_to_local(const double world[16], const double v[3], double out[3]) {
  const double* x = world;
  const double* y = world + 4;
  const double* z = world + 8;
  double yz[3], zx[3], xy[3], determinant;
  pellucid_cross(y, z, yz);
  pellucid_cross(z, x, zx);
  pellucid_cross(x, y, xy);
  determinant = pellucid_dot(x, yz);
  out[0] = pellucid_dot(yz, v) / determinant;
  out[1] = pellucid_dot(zx, v) / determinant;
  out[2] = pellucid_dot(xy, v) / determinant;
  /* For a singular matrix, the division by zero gives infinities or NaN. */
  return out[0] - out[0] + out[1] - out[1] + out[2] - out[2] == 0;
}

/* Returns the view of a perspective camera at the position `camera` in world space. */
static inline PellucidView pellucid_perspective_view(const PellucidOrders* orders, const double world[16],
                                                     const double camera[3]) {
  PellucidView view = {{0, 0, 0}, 0, 0};
  double offset[3], d[3];
  int i;
  for (i = 0; i < 3; ++i) offset[i] = camera[i] - world[12 + i];
  if (!pellucid_to_local(world, offset, view.direction)) return view;
  for (i = 0; i < 3; ++i) view.direction[i] -= orders->center[i];
  view.valid = pellucid_normalize(view.direction, d);
  view.distance = sqrt(pellucid_dot(view.direction, view.direction)) / orders->radius;
  return view;
}

/* Returns the view of an orthographic camera that looks along `forward` in world space. The direction is the
 * same for all meshes. */
static inline PellucidView pellucid_orthographic_view(const double world[16], const double forward[3]) {
  PellucidView view = {{0, 0, 0}, HUGE_VAL, 0};
  double d[3];
  int i;
  if (!pellucid_to_local(world, forward, view.direction)) return view;
  for (i = 0; i < 3; ++i) view.direction[i] = -view.direction[i];
  view.valid = pellucid_normalize(view.direction, d);
  return view;
}

/* Returns whether the orders are valid for a view. */
static inline int pellucid_in_range(const PellucidOrders* orders, const PellucidView* view) {
  return view->valid && view->distance >= orders->min_distance && view->distance <= orders->max_distance;
}

/* Returns the index into cell_orders: a triangle (S, T, R) or a corner of a triangle (P). */
static inline uint32_t pellucid_find_cell(const PellucidOrders* orders, const double direction[3]) {
  return orders->cells == pellucid_cells_corners ? pellucid_find_corner(orders->level, direction)
                                                 : pellucid_find_triangle(orders->level, direction);
}

/* Reads an entry of cell_orders. */
static inline uint32_t pellucid_order_of_cell(const PellucidOrders* orders, uint32_t cell) {
  switch (orders->cell_order_bytes) {
    case 1:
      return PELLUCID_RUNTIME_CAST(const uint8_t*, orders->cell_orders)[cell];
    case 2:
      return PELLUCID_RUNTIME_CAST(const uint16_t*, orders->cell_orders)[cell];
    default:
      return PELLUCID_RUNTIME_CAST(const uint32_t*, orders->cell_orders)[cell];
  }
}

/* Returns the order for a view, or the fallback if the orders are not valid for it. */
static inline uint32_t pellucid_select_order(const PellucidOrders* orders, const PellucidView* view) {
  if (!pellucid_in_range(orders, view)) return orders->fallback_order;
  return pellucid_order_of_cell(orders, pellucid_find_cell(orders, view->direction));
}

/* Returns the order for a perspective camera at the position `camera` in world space. */
static inline uint32_t pellucid_select_perspective(const PellucidOrders* orders, const double world[16],
                                                   const double camera[3]) {
  const PellucidView view = pellucid_perspective_view(orders, world, camera);
  return pellucid_select_order(orders, &view);
}

/* Returns the order for an orthographic camera that looks along `forward` in world space. */
static inline uint32_t pellucid_select_orthographic(const PellucidOrders* orders, const double world[16],
                                                    const double forward[3]) {
  const PellucidView view = pellucid_orthographic_view(world, forward);
  return pellucid_select_order(orders, &view);
}

/* ----------------------------------------------------------------------------- animated overdraw orders
 *
 * Orders of purpose "overdraw" are drawn with a depth test, so any of them draws the correct image from
 * anywhere. The functions below therefore always return an order and have no fallback. minDistance and
 * maxDistance say for which cameras the orders were made, but nearer and farther cameras use the same table.
 * Without a direction (singular matrix, camera at the centre, NaN) the order is that of cell 0.
 *
 * Spheres and directions are in the space of the file's scene and are the same for all primitives of a model.
 * You can select once for a whole model or once per primitive. The result is the same if their tables are the
 * same. */

/* One element of `keyframes`, with the data of its accessors, little-endian and aligned. */
typedef struct PellucidKeyframes {
  const float* times;        /* `count` times in seconds, strictly increasing */
  const float* spheres;      /* `count` times the centre x y z and the radius of the posed model */
  uint32_t count;            /* 0 if no animation plays and the model is at rest */
  const void* cell_orders;   /* `count` rows, each like PellucidOrders::cell_orders */
  uint32_t cell_order_bytes; /* 1, 2 or 4 */
} PellucidKeyframes;

/* Returns the key frame nearest to `time` in seconds, and the earlier one of two that are equally near.
 * Returns the first or last one for a time before or after all of them, and 0 for NaN. Takes O(log count).
 * For an animation that loops, pass fmod(time, duration). */
static inline uint32_t pellucid_nearest_keyframe(const PellucidKeyframes* keyframes, double time) {
  /* Invariant: times[low] <= time < times[high], where high may be one past the end. */
  uint32_t low = 0, high = keyframes->count;
  if (high == 0 || !(time > PELLUCID_RUNTIME_CAST(double, keyframes->times[0]))) return 0;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    if (PELLUCID_RUNTIME_CAST(double, keyframes->times[middle]) <= time)
      low = middle;
    else
      high = middle;
  }
  if (high == keyframes->count) return low;
  return time - PELLUCID_RUNTIME_CAST(double, keyframes->times[low]) <=
                 PELLUCID_RUNTIME_CAST(double, keyframes->times[high]) - time
             ? low
             : high;
}

/* Returns the number of entries of one row of cell_orders. */
static inline uint32_t pellucid_cell_count(const PellucidOrders* orders) {
  return pellucid_triangle_count(orders->level) * (orders->cells == pellucid_cells_corners ? 3u : 1u);
}

/* Returns the orders at a time of an animation, with the sphere and the table of the nearest key frame. If
 * `keyframes` is null or its count is 0, these are the ones of the model at rest. Valid at all distances. */
static inline PellucidOrders pellucid_orders_at(const PellucidOrders* orders,
                                                const PellucidKeyframes* keyframes, double time) {
  PellucidOrders at = *orders;
  at.min_distance = 0;
  at.max_distance = HUGE_VAL;
  if (keyframes && keyframes->count > 0) {
    const uint32_t frame = pellucid_nearest_keyframe(keyframes, time);
    const float* sphere = keyframes->spheres + PELLUCID_RUNTIME_CAST(uint64_t, frame) * 4;
    const uint64_t row =
        PELLUCID_RUNTIME_CAST(uint64_t, frame) * pellucid_cell_count(orders) * keyframes->cell_order_bytes;
    int i;
    for (i = 0; i < 3; ++i) at.center[i] = PELLUCID_RUNTIME_CAST(double, sphere[i]);
    at.radius = PELLUCID_RUNTIME_CAST(double, sphere[3]);
    at.cell_orders = PELLUCID_RUNTIME_CAST(const uint8_t*, keyframes->cell_orders) + row;
    at.cell_order_bytes = keyframes->cell_order_bytes;
  }
  return at;
}

/* Returns the order for a perspective camera at the position `camera` in world space. `model_world` maps the
 * scene of the file to the world. It is not the matrix of a node, which an animation may change. */
static inline uint32_t pellucid_select_animated(const PellucidOrders* orders,
                                                const PellucidKeyframes* keyframes, double time,
                                                const double model_world[16], const double camera[3]) {
  const PellucidOrders at = pellucid_orders_at(orders, keyframes, time);
  const PellucidView view = pellucid_perspective_view(&at, model_world, camera);
  return pellucid_order_of_cell(&at, pellucid_find_cell(&at, view.direction));
}

/* Returns the order for an orthographic camera that looks along `forward` in world space. */
static inline uint32_t pellucid_select_animated_orthographic(const PellucidOrders* orders,
                                                             const PellucidKeyframes* keyframes, double time,
                                                             const double model_world[16],
                                                             const double forward[3]) {
  const PellucidOrders at = pellucid_orders_at(orders, keyframes, time);
  const PellucidView view = pellucid_orthographic_view(model_world, forward);
  return pellucid_order_of_cell(&at, pellucid_find_cell(&at, view.direction));
}

#ifdef __cplusplus
}
#endif
#undef PELLUCID_RUNTIME_CAST

#endif /* PELLUCID_RUNTIME_SELECT_H */
