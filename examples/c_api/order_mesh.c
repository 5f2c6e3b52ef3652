/* Orders a mesh, measures the orders, and selects the order for an eye, in C.
 *
 *   order_mesh                      orders a mesh that is made here
 *   order_mesh MODEL OUT.glb        orders the first primitive of a model, and writes OUT.glb
 *
 *   cc -std=c99 order_mesh.c $(pkg-config --cflags --libs pellucid-c) -lm -o order_mesh */
#include <pellucid/c/pellucid.h>
#include <stdio.h>
#include <stdlib.h>

/* Every call returns a status. The text says what was wrong. */
static void check(PellucidStatus status) {
  if (status == pellucid_ok) return;
  fprintf(stderr, "order_mesh: %s\n", pellucid_last_error());
  exit(1);
}

/* Return anything but 0 to stop. */
static int show_progress(void* user, const char* stage, uint64_t done, uint64_t total) {
  (void)user;
  if (total > 0) fprintf(stderr, "\r%-10s %3.0f %% ", stage, 100.0 * (double)done / (double)total);
  return 0;
}

#define AROUND 32
#define ACROSS 12

/* A torus overlaps itself, so that one order does not serve all views. */
static PellucidMesh make_torus(void) {
  static float positions[AROUND * ACROSS][3];
  static uint32_t indices[AROUND * ACROSS * 2][3];
  uint32_t i, j;
  for (i = 0; i < AROUND; ++i) {
    for (j = 0; j < ACROSS; ++j) {
      const double u = 2 * PELLUCID_PI * i / AROUND, v = 2 * PELLUCID_PI * j / ACROSS;
      const uint32_t next_i = (i + 1) % AROUND, next_j = (j + 1) % ACROSS, a = i * ACROSS + j;
      const uint32_t b = next_i * ACROSS + j, c = next_i * ACROSS + next_j, d = i * ACROSS + next_j;
      const uint32_t both[2][3] = {{a, b, c}, {a, c, d}};
      int t, k;
      positions[a][0] = (float)((1 + 0.4 * cos(v)) * cos(u));
      positions[a][1] = (float)((1 + 0.4 * cos(v)) * sin(u));
      positions[a][2] = (float)(0.4 * sin(v));
      for (t = 0; t < 2; ++t)
        for (k = 0; k < 3; ++k) indices[2 * a + (uint32_t)t][k] = both[t][k];
    }
  }
  return (PellucidMesh){.positions = positions[0],
                        .vertex_count = AROUND * ACROSS,
                        .indices = indices,
                        .index_bytes = 4,
                        .triangle_count = AROUND * ACROSS * 2};
}

static PellucidOrderSet* order(const PellucidMesh* mesh, PellucidFacing facing) {
  PellucidOrderOptions options;
  PellucidOrderSet* orders;
  pellucid_order_options_init(&options, sizeof options);
  options.run.progress = show_progress;
  options.facing = facing;
  options.views = "S1,1"; /* 80 view cells are quick. The default, "S2,2", has 320. */
  check(pellucid_order_mesh(mesh, &options, &orders));
  fprintf(stderr, "\n");
  return orders;
}

static void print_figures(const PellucidMesh* mesh, const PellucidOrderSet* orders) {
  PellucidOrderStatistics made;
  PellucidMeasureOptions options;
  PellucidBlendQuality presorted, stored;
  check(pellucid_order_statistics(orders, &made, sizeof made));
  printf("%llu triangles, %u orders, %llu bytes of indices\n", (unsigned long long)made.triangles,
         (unsigned)pellucid_order_count(orders), (unsigned long long)made.index_bytes);
  pellucid_measure_options_init(&options, sizeof options);
  options.viewpoints = 50;
  options.size = 256;
  check(pellucid_measure_blending(mesh, orders, &options, &presorted));
  check(pellucid_measure_blending(mesh, NULL, &options, &stored));
  printf("wrong pixels: %.3f %% in draw order, %.1f %% in stored order; PSNR %.1f and %.1f dB\n",
         100 * presorted.ipr_mean, 100 * stored.ipr_mean, presorted.psnr_mean, stored.psnr_mean);
}

/* Uploads the order for an eye. A program gets the selector once, and selects an order in every frame. */
static void draw_from(const PellucidOrderSet* orders, uint32_t vertex_count, const double eye[3]) {
  static const double world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  PellucidOrders selector;
  PellucidCacheQuality cache;
  uint64_t count;
  uint32_t chosen;
  uint32_t* indices;
  check(pellucid_order_selector(orders, &selector));

  chosen = pellucid_select_perspective(&selector, world, eye);

  count = pellucid_order_index_count(orders, chosen);
  indices = malloc(count * sizeof *indices);
  check(pellucid_copy_order_indices(orders, chosen, pellucid_back_to_front, 4, indices));
  check(pellucid_measure_cache(indices, 4, count, vertex_count, pellucid_cache_fifo, 20, &cache));
  printf("from (%g, %g, %g): draw order %d, %llu indices, ACMR %.2f\n", eye[0], eye[1], eye[2], (int)chosen,
         (unsigned long long)count, cache.acmr);
  free(indices);
}

int main(int argc, char** argv) {
  const double eyes[2][3] = {{3, 1, 2}, {-1, 0.5, -4}};
  PellucidMesh mesh = make_torus();
  PellucidModel* model = NULL;
  PellucidPrimitive primitive = {0};
  PellucidOrderSet* orders;
  if (argc != 1 && argc != 3) {
    fprintf(stderr, "usage: order_mesh [MODEL OUT.glb]\n");
    return 2;
  }
  if (argc == 3) {
    check(pellucid_read_model(argv[1], &model));
    check(pellucid_model_primitive(model, 0, &primitive, sizeof primitive));
    mesh = primitive.mesh; /* its arrays belong to the model */
  }
  orders = order(&mesh,
                 argc == 3 && !primitive.double_sided ? pellucid_facing_single : pellucid_facing_duplicated);
  print_figures(&mesh, orders);
  draw_from(orders, mesh.vertex_count, eyes[0]);
  draw_from(orders, mesh.vertex_count, eyes[1]);
  if (argc == 3) {
    check(pellucid_model_set_orders(model, 0, orders));
    check(pellucid_write_model(model, argv[2], NULL));
    printf("wrote %s\n", argv[2]);
  }
  pellucid_free_order_set(orders);
  pellucid_free_model(model);
  return 0;
}
