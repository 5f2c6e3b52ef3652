/* Shows how an engine draws a translucent mesh with pellucid: it orders the mesh once, selects an order in
 * every frame, and never sorts.
 *
 *   vulkan_engine OUT.ppm
 *
 * All uses of pellucid are in this file: order_shape(), upload_orders(), and the loop of main(). The orders
 * are made here so that the example needs no file. A game makes them offline (pellucid order) and loads them
 * from the glTF or from its own format. The image shows the last frame in draw order, and beside it in the
 * stored order. The program fails unless its frames are much closer to frames whose triangles were sorted on
 * the CPU than frames in the stored order are. */
#include <pellucid/c/pellucid.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine.h"
#include "shape.h"

enum { kFrames = 8, kMaxOrders = 8, kBothFacings = 6 * kTriangles, kImageBytes = kWidth * kHeight * 4 };

static const double kWorld[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static void check(PellucidStatus status) {
  if (status == pellucid_ok) return;
  fprintf(stderr, "vulkan_engine: %s\n", pellucid_last_error());
  exit(1);
}

/* A run of the index buffer. */
typedef struct Range {
  uint32_t first, count;
} Range;

/* ------------------------------------------------------------------------------------- once, at load time */

static PellucidOrderSet* order_shape(const Shape* shape) {
  const PellucidMesh mesh = {.positions = shape->vertices[0].position,
                             .vertex_count = kVertices,
                             .position_stride = sizeof(Vertex),
                             .indices = shape->triangles,
                             .index_bytes = 4,
                             .triangle_count = kTriangles};
  PellucidOrderOptions options;
  PellucidOrderSet* orders;
  pellucid_order_options_init(&options, sizeof options);
  options.views = "S1,1"; /* coarse, to be quick */
  options.max_buffers = kMaxOrders;
  check(pellucid_order_mesh(&mesh, &options, &orders));
  return orders;
}

/* Writes all orders to one index buffer. ranges[count] is the order for eyes for which the others do not
 * hold. */
static uint32_t upload_orders(const PellucidOrderSet* orders, uint32_t* indices,
                              Range ranges[kMaxOrders + 1]) {
  const uint32_t count = pellucid_order_count(orders);
  uint32_t end = 0, i;
  for (i = 0; i <= count; ++i) {
    const uint32_t order = i < count ? i : PELLUCID_NO_ORDER;
    check(pellucid_copy_order_indices(orders, order, pellucid_back_to_front, 4, indices + end));
    ranges[i].first = end;
    ranges[i].count = (uint32_t)pellucid_order_index_count(orders, order);
    end += ranges[i].count;
  }
  return end;
}

/* ---------------------------------------------------------------------------------------- the comparison */

typedef struct Keyed {
  double distance;
  uint32_t triangle;
} Keyed;

static int farther_first(const void* a, const void* b) {
  const double difference = ((const Keyed*)b)->distance - ((const Keyed*)a)->distance;
  return difference > 0 ? 1 : difference < 0 ? -1 : 0;
}

/* Writes both facings of all triangles: as they are stored, or sorted by the distance of their centroids from
 * the eye, farthest first. An engine without draw orders sorts and uploads like this in every frame. */
static void write_triangles(const Shape* shape, const double* eye, uint32_t* indices) {
  static Keyed keyed[kTriangles];
  uint32_t i;
  int k;
  for (i = 0; i < kTriangles; ++i) {
    const uint32_t* t = shape->triangles[i];
    keyed[i] = (Keyed){0, i};
    for (k = 0; k < 3 && eye; ++k) {
      const double middle = (shape->vertices[t[0]].position[k] + shape->vertices[t[1]].position[k] +
                             shape->vertices[t[2]].position[k]) /
                            3.0;
      keyed[i].distance += (middle - eye[k]) * (middle - eye[k]);
    }
  }
  if (eye) qsort(keyed, kTriangles, sizeof *keyed, farther_first);
  for (i = 0; i < kTriangles; ++i) {
    const uint32_t* t = shape->triangles[keyed[i].triangle];
    const uint32_t both[6] = {t[0], t[1], t[2], t[0], t[2], t[1]};
    memcpy(indices + 6 * i, both, sizeof both);
  }
}

/* Returns the share of pixels that differ by more than rounding, of those that show the mesh in the first
 * image. */
static double share_of_difference(const uint8_t* a, const uint8_t* b) {
  uint32_t covered = 0, different = 0, p;
  for (p = 0; p < kWidth * kHeight; ++p, a += 4, b += 4) {
    if (a[0] == 255 && a[1] == 255 && a[2] == 255) continue;
    ++covered;
    different += abs(a[0] - b[0]) > 2 || abs(a[1] - b[1]) > 2 || abs(a[2] - b[2]) > 2;
  }
  return covered ? (double)different / covered : 0;
}

/* -------------------------------------------------------------------------------------------- the camera */

/* Looks at the origin, z is up; a right-handed world, depth 0..1. */
static Frame look_from(const double eye[3]) {
  const double near = 0.5, far = 50, zoom = 1 / tan(0.38);
  const double distance = sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]);
  const double flat = sqrt(eye[0] * eye[0] + eye[1] * eye[1]);
  const double back[3] = {eye[0] / distance, eye[1] / distance, eye[2] / distance};
  const double right[3] = {-eye[1] / flat, eye[0] / flat, 0};
  const double up[3] = {back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
                        back[0] * right[1] - back[1] * right[0]};
  Frame frame = {{0}, {(float)eye[0], (float)eye[1], (float)eye[2], 1}};
  int k;
  for (k = 0; k < 3; ++k) {
    frame.clip_from_world[4 * k] = (float)(zoom * right[k]);
    frame.clip_from_world[4 * k + 1] = (float)(zoom * up[k]);
    frame.clip_from_world[4 * k + 2] = (float)(far / (near - far) * back[k]);
    frame.clip_from_world[4 * k + 3] = (float)-back[k];
  }
  frame.clip_from_world[14] = (float)(far / (near - far) * -distance + near * far / (near - far));
  frame.clip_from_world[15] = (float)distance;
  return frame;
}

static void write_ppm(const char* path, const uint8_t* left, const uint8_t* right) {
  const uint8_t* halves[2] = {left, right};
  FILE* file = fopen(path, "wb");
  int y, half, x;
  if (!file) {
    fprintf(stderr, "vulkan_engine: %s cannot be written\n", path);
    exit(1);
  }
  fprintf(file, "P6\n%d %d\n255\n", 2 * kWidth, kHeight);
  for (y = 0; y < kHeight; ++y)
    for (half = 0; half < 2; ++half)
      for (x = 0; x < kWidth; ++x) fwrite(halves[half] + 4 * (y * kWidth + x), 1, 3, file);
  fclose(file);
}

int main(int argc, char** argv) {
  static Shape shape;
  static uint8_t ordered[kImageBytes], as_stored[kImageBytes];
  double wrong_ordered = 0, wrong_stored = 0;
  Range ranges[kMaxOrders + 1];
  PellucidOrderSet* orders;
  PellucidOrders selector;
  Engine engine;
  uint32_t* indices;
  uint32_t end;
  int f;
  if (argc != 2) {
    fprintf(stderr, "usage: vulkan_engine OUT.ppm\n");
    return 2;
  }
  make_chain(&shape);
  orders = order_shape(&shape);
  check(pellucid_order_selector(orders, &selector));
  engine = make_engine(shape.vertices, sizeof shape.vertices,
                       (size_t)(kMaxOrders + 3) * kBothFacings * sizeof(uint32_t));
  indices = engine.indices.mapped;
  end = upload_orders(orders, indices, ranges);
  const Range stored = {end, kBothFacings}, sorted = {end + kBothFacings, kBothFacings};
  write_triangles(&shape, NULL, indices + stored.first);

  for (f = 0; f < kFrames; ++f) {
    const double turn = 2 * PELLUCID_PI * (f + 0.3) / kFrames;
    const double eye[3] = {10 * cos(turn), 10 * sin(turn), 5 * sin(2 * turn) + 3};
    const Frame frame = look_from(eye);

    /* This is all that drawing in order takes. */
    const uint32_t order = pellucid_select_perspective(&selector, kWorld, eye);
    const Range* range = &ranges[order == PELLUCID_NO_ORDER ? pellucid_order_count(orders) : order];
    memcpy(ordered, draw(&engine, &frame, range->first, range->count), kImageBytes);

    memcpy(as_stored, draw(&engine, &frame, stored.first, stored.count), kImageBytes);
    write_triangles(&shape, eye, indices + sorted.first);
    const uint8_t* truth = draw(&engine, &frame, sorted.first, sorted.count);
    wrong_ordered += share_of_difference(truth, ordered) / kFrames;
    wrong_stored += share_of_difference(truth, as_stored) / kFrames;
    printf("frame %d: order %d\n", f, (int)order);
  }
  write_ppm(argv[1], ordered, as_stored);
  printf(
      "%u orders; pixels unlike those of a sort in every frame: %.2f %% in draw order, %.1f %% in stored "
      "order\n",
      (unsigned)pellucid_order_count(orders), 100 * wrong_ordered, 100 * wrong_stored);
  free_engine(&engine);
  pellucid_free_order_set(orders);
  return wrong_ordered < 0.1 * wrong_stored ? 0 : 1;
}
