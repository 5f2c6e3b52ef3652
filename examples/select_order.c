/* Selects the index buffer to draw for a camera. This is all that a renderer needs of pellucid at run time.
 *
 *   cc -std=c99 -Iinclude examples/select_order.c -lm -o select_order && ./select_order */
#include <stdio.h>

#include "pellucid/runtime/select.h"

int main(void) {
  /* From the file: the members of PELLUCID_mesh_primitive_view_orders and the bytes of its cellOrders
   * accessor. Here, orders 0, 1, 2 over the 20 cells of level 0. */
  static const uint8_t cell_orders[20] = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1};
  const PellucidOrders orders = {.cells = pellucid_cells_triangles,
                                 .level = 0,
                                 .center = {0, 0, 0},
                                 .radius = 1.0,
                                 .min_distance = 1,
                                 .max_distance = HUGE_VAL,
                                 .cell_orders = cell_orders,
                                 .cell_order_bytes = 1,
                                 .fallback_order = PELLUCID_NO_ORDER};

  /* From the scene, every frame: the node's world matrix (column-major) and where the camera is. */
  const double world[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1};
  const double cameras[3][3] = {{10, -9, 2}, {19, 9, 9}, {10.5, 0, 0}};
  for (int i = 0; i < 3; ++i) {
    const uint32_t order = pellucid_select_perspective(&orders, world, cameras[i]);
    if (order == PELLUCID_NO_ORDER) {
      printf("camera %d is too near: draw primitive.indices\n", i);
    } else {
      printf("camera %d: draw order %u\n", i, (unsigned)order);
    }
  }
  return 0;
}
