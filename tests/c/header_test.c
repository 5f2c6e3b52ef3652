/* Uses pellucid/c/pellucid.h as a C99 program does. The header compiles alone, and the exit code says whether
 * it works. */
#include "pellucid/c/pellucid.h"

int main(void) {
  /* Two squares, one before the other. */
  static const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
  static const uint16_t indices[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  static const double world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  static const double eye[3] = {0.5, 0.5, 5};
  PellucidMesh mesh = {positions, 8, 0, indices, 2, 4};
  PellucidOrderOptions options;
  PellucidOrderSet* orders = NULL;
  PellucidOrders selector;
  uint32_t order;
  uint16_t drawn[24];

  pellucid_order_options_init(&options, sizeof options);
  options.views = "S0,1";
  options.facing = pellucid_facing_single;
  if (pellucid_order_mesh(&mesh, &options, &orders) != pellucid_ok) return 1;
  if (pellucid_order_selector(orders, &selector) != pellucid_ok) return 2;
  order = pellucid_select_perspective(&selector, world, eye);
  if (order >= pellucid_order_count(orders)) return 3;
  if (pellucid_order_index_count(orders, order) > 24) return 4;
  if (pellucid_copy_order_indices(orders, order, pellucid_front_to_back, 2, drawn) != pellucid_ok) return 5;
  /* From above, the upper square comes first: its indices are 4 to 7. */
  if (drawn[0] < 4) return 6;
  pellucid_free_order_set(orders);
  return 0;
}
