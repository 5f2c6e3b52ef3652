/* pellucid/runtime/select.h as a C99 program uses it: it compiles alone, and its exit code says whether it
 * works. */
#include "pellucid/runtime/select.h"

static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static int middle_of_each_triangle_is_found(uint32_t level) {
  uint32_t t;
  for (t = 0; t < pellucid_triangle_count(level); ++t) {
    double corners[3][3], middle[3];
    int i;
    pellucid_triangle_corners(level, t, corners);
    for (i = 0; i < 3; ++i) middle[i] = corners[0][i] + corners[1][i] + corners[2][i];
    if (pellucid_find_triangle(level, middle) != t) return 0;
  }
  return 1;
}

static int orders_are_read_in_all_widths(void) {
  static uint8_t bytes[320];
  static uint16_t shorts[320];
  static uint32_t words[320];
  const double camera[3] = {3, 1, -2};
  PellucidOrders orders = {pellucid_cells_triangles, 2, {0, 0, 0}, 1, 1.5, HUGE_VAL, bytes, 1,
                           PELLUCID_NO_ORDER};
  const uint32_t cell = pellucid_find_triangle(2, camera);
  bytes[cell] = 7;
  shorts[cell] = 700;
  words[cell] = 70000;
  if (pellucid_select_perspective(&orders, identity, camera) != 7) return 0;
  orders.cell_orders = shorts;
  orders.cell_order_bytes = 2;
  if (pellucid_select_perspective(&orders, identity, camera) != 700) return 0;
  orders.cell_orders = words;
  orders.cell_order_bytes = 4;
  return pellucid_select_perspective(&orders, identity, camera) == 70000;
}

static int key_frames_choose_sphere_and_row(void) {
  static const float times[2] = {1, 2};
  static const float spheres[8] = {0, 0, 0, 1, 10, 0, 0, 1};
  static uint16_t rows[2 * 20];
  const double camera[3] = {5, 1, 2}, from_second[3] = {-5, 1, 2}, forward[3] = {-1, 0, 0},
               back[3] = {1, 0, 0};
  const PellucidOrders orders = {pellucid_cells_triangles, 0, {0, 0, 0}, 1, 3, 4, rows, 2, PELLUCID_NO_ORDER};
  const PellucidKeyframes keyframes = {times, spheres, 2, rows, 2};
  uint32_t i;
  for (i = 0; i < 40; ++i) rows[i] = (uint16_t)i;
  return pellucid_select_animated(&orders, &keyframes, 1.5, identity, camera) ==
             pellucid_find_triangle(0, camera) &&
         pellucid_select_animated(&orders, &keyframes, 1.75, identity, camera) ==
             20 + pellucid_find_triangle(0, from_second) &&
         pellucid_select_animated_orthographic(&orders, &keyframes, 9, identity, forward) ==
             20 + pellucid_find_triangle(0, back);
}

int main(void) {
  if (!middle_of_each_triangle_is_found(0)) return 1;
  if (!middle_of_each_triangle_is_found(4)) return 2;
  if (!orders_are_read_in_all_widths()) return 3;
  if (!key_frames_choose_sphere_and_row()) return 4;
  return 0;
}
