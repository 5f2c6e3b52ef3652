/* Selects the index buffer that shades the fewest hidden pixels of an animated model, for a camera and a
 * time. A renderer does this with orders of purpose "overdraw".
 *
 *   cc -std=c99 -Iinclude examples/select_animated.c -lm -o select_animated && ./select_animated */
#include <stdio.h>

#include "pellucid/runtime/select.h"

int main(void) {
  /* From the file: the accessors of one of `keyframes`. Here the model walks along x in one second; orders 0
   * and 1 serve views from ahead and from behind, order 2 its last pose from everywhere. */
  static const float times[3] = {0.0f, 0.5f, 1.0f};
  static const float spheres[12] = {0, 0, 0, 1, 5, 0, 0, 1, 10, 0, 0, 1};
  static const uint8_t at_rest[20] = {0};
  static const uint8_t cell_orders[60] = {
      1, 0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, /* one row per key frame, */
      1, 0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, /* one entry per cell */
      2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2};
  const PellucidOrders orders = {.level = 0, .radius = 1.0, .cell_orders = at_rest, .cell_order_bytes = 1};
  const PellucidKeyframes walk = {times, spheres, 3, cell_orders, 1};

  /* Every frame: time in the animation, where the model's scene and the camera are. */
  const double model_world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const double camera[3] = {1, 4, 0};
  for (int frame = 0; frame < 3; ++frame) {
    const double time = 0.45 * frame; /* an animation that loops: fmod(seconds, duration) */
    const uint32_t order = pellucid_select_animated(&orders, &walk, time, model_world, camera);
    printf("%.2f s: draw order %u\n", time, (unsigned)order);
  }
  return 0;
}
