/* pellucid/c/pellucid.h - the C interface of pellucid: orders of triangles, from C99 or whatever can call C.
 *
 * In: triangle meshes as arrays, or model files. Out: order sets - a few index buffers for a mesh and the
 * table that says which of them to draw from where - as arrays, or in glTF files. Link libpellucid.so (CMake:
 * find_package(pellucid COMPONENTS c), pellucid::c; pkg-config: pellucid-c). docs/c-api.md is the guide.
 *
 * CONVENTIONS
 *   Shapes     Positions are x y z, float; three indices a triangle, counter-clockwise seen from the front.
 *   Space      Right-handed. Directions and eyes are in the mesh's own space, distances of viewpoints in
 *              radii of its bounding sphere (round the middle of the bounding box), ratios plain numbers.
 *   Status     Functions that can fail return a PellucidStatus; what they should have given is then null or
 *              as it was. pellucid_last_error() says why, in one line. Others cannot fail for valid handles.
 *   Ownership  Arrays that are passed in are copied, and yours. Handles end with their pellucid_free_*();
 *              what is said to belong to a handle ends with it. Freeing null does nothing.
 *   Options    Always begin with the init function, then change members; null stands for all defaults. The
 *              size that init takes is `sizeof` the structure: programs go on working with later libraries,
 *              whose structures may have more members at the end.
 *   Threads    All functions may be called from several threads at once. An order set never changes: threads
 *              may share it. A model may be read by several threads while none changes it.
 *   Results    The same input, options and seed give the same result, for any number of threads.
 *   Signals, stdout, globals: none are touched. No C++ exception leaves the library. */
#ifndef PELLUCID_C_PELLUCID_H
#define PELLUCID_C_PELLUCID_H

#include <stddef.h>
#include <stdint.h>

#include "pellucid/runtime/select.h"

#if defined(_WIN32) && defined(PELLUCID_BUILDS_C_LIBRARY)
#define PELLUCID_API __declspec(dllexport)
#elif defined(_WIN32)
#define PELLUCID_API __declspec(dllimport)
#elif defined(__GNUC__)
#define PELLUCID_API __attribute__((visibility("default")))
#else
#define PELLUCID_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------ status and version */

typedef enum PellucidStatus {
  pellucid_ok = 0,
  pellucid_bad_argument = 1,  /* the call makes no sense: null, out of range, contradicting options */
  pellucid_bad_input = 2,     /* a file is missing, truncated, hostile, or not what it claims to be */
  pellucid_nothing_to_do = 3, /* valid input without anything to work on: no triangle, no orders */
  pellucid_cannot_write = 4,  /* no permission, disk full */
  pellucid_cancelled = 5,     /* the progress function said so */
  pellucid_out_of_memory = 6,
  pellucid_internal = 7 /* a bug in pellucid */
} PellucidStatus;

/* Why the last failing call of this thread failed: what, and with which file or argument. Empty before the
 * first. Valid until this thread's next failing call. */
PELLUCID_API const char* pellucid_last_error(void);

/* "0.1.0": of the library that is linked at run time. */
PELLUCID_API const char* pellucid_version(void);

/* ---------------------------------------------------------------------------------------------- progress */

/* Told every now and then while a long call works, at every stage and then at most every 20 ms, from any
 * thread but never from two at once. `stage` ends with the call. `total` 0: the amount of work is not known.
 * Returns 0 to go on, else the call ends soon with pellucid_cancelled. Must not throw, nor jump out. */
typedef int (*PellucidProgress)(void* user, const char* stage, uint64_t done, uint64_t total);

/* Members of every options structure of long calls. */
typedef struct PellucidRun {
  PellucidProgress progress; /* null: none */
  void* user;                /* given back to `progress` */
  uint32_t threads;          /* 0: one per core. Limits the whole process while the call runs */
} PellucidRun;

/* ------------------------------------------------------------------------------------------------ meshes */

/* Triangles that draw nothing (an index >= vertex_count, a corner NaN or infinite, no area) are left out of
 * transparency orders; overdraw orders keep all, but refuse indices out of range. */
typedef struct PellucidMesh {
  const float* positions; /* x y z of every vertex */
  uint32_t vertex_count;
  uint32_t position_stride; /* bytes from one vertex to the next, a multiple of 4; 0: 12 */
  const void* indices;      /* three for every triangle */
  uint32_t index_bytes;     /* 2 or 4 */
  uint32_t triangle_count;
} PellucidMesh;

/* ------------------------------------------------------------------------------------ transparency orders */

/* Index buffers and the table that says which of them draws from where. */
typedef struct PellucidOrderSet PellucidOrderSet;

typedef enum PellucidMethod {
  pellucid_method_budget = 0, /* the fewest orders whose measured error is at most max_error */
  pellucid_method_acyclic = 1 /* as many as no sampled view contradicts: In-Depth Buffers */
} PellucidMethod;

typedef enum PellucidFacing {
  pellucid_facing_duplicated = 0, /* both sides are drawn: orders hold flipped twins, back faces are culled */
  pellucid_facing_single = 1      /* only fronts are drawn */
} PellucidFacing;

typedef struct PellucidOrderOptions {
  size_t struct_size; /* set by init */
  PellucidRun run;
  PellucidMethod method; /* budget */
  PellucidFacing facing; /* duplicated */
  const char* views;     /* cells of view directions: "S2,2" (320 cells), "S1,1", "P2", "T2", ... */
  /* Distances of the sampled cameras, in radii, >= 1; HUGE_VAL for orthographic ones. Null: the default. */
  const double* distances;
  uint32_t distance_count;
  double max_error;     /* budget: share of wrong pixels, 0.001 */
  uint32_t max_buffers; /* budget: 16 */
  uint32_t min_buffers; /* budget: 1; equal to max_buffers: that many, but none that no view would use */
  double tolerance;     /* overlaps thinner than this many radii do not count; < 0: the method's own */
  double alpha;         /* opacity to weigh occlusions by, 0..1; 0: by their area alone */
  uint32_t cache_size;  /* FIFO vertex cache to optimise for, 20; 0: do not */
  uint32_t
      upsample_from; /* order a mesh simplified to so many triangles; 0: never; UINT32_MAX: above 24,000 */
  uint64_t memory;   /* bytes to get by with; 0: no limit */
  uint64_t seed;     /* 1 */
} PellucidOrderOptions;
PELLUCID_API void pellucid_order_options_init(PellucidOrderOptions* options, size_t struct_size);

/* Orders for blending a static mesh. Seconds to minutes: about linear in triangles up to 24,000. */
PELLUCID_API PellucidStatus pellucid_order_mesh(const PellucidMesh* mesh, const PellucidOrderOptions* options,
                                                PellucidOrderSet** orders);

/* --------------------------------------------------------------------------------------- overdraw orders */

typedef enum PellucidOverdrawMethod {
  pellucid_overdraw_refined = 0,
  pellucid_overdraw_paper = 1 /* Triangle Reordering for Efficient Rendering in Complex Scenes */
} PellucidOverdrawMethod;

typedef struct PellucidOverdrawOptions {
  size_t struct_size; /* set by init */
  PellucidRun run;
  PellucidOverdrawMethod method;     /* refined */
  PellucidFacing facing;             /* single: back faces are culled. duplicated: both sides are drawn */
  uint32_t buffers;                  /* 5; a mesh without poses may do with 1 */
  double lambda;                     /* vertex cache against overdraw: 0.85; 3: every triangle is a patch */
  uint32_t cache_size;               /* FIFO entries, 16 */
  uint32_t view_level;               /* 10 * 4^n + 2 viewpoints: 2, at most 5 */
  double min_distance, max_distance; /* of these viewpoints, radii: 1.5 to 3 */
  uint32_t size;                     /* pixels a side of the pictures that overdraw is counted in: 256 */
  uint64_t seed;                     /* 1 */
} PellucidOverdrawOptions;
PELLUCID_API void pellucid_overdraw_options_init(PellucidOverdrawOptions* options, size_t struct_size);

/* Key frames of an animated mesh. */
typedef struct PellucidPoses {
  const float* const* positions; /* of every key frame: laid out as PellucidMesh::positions */
  const float* times;            /* seconds, strictly increasing */
  uint32_t frame_count;
} PellucidPoses;

/* Orders that shade little in vain, for opaque meshes. `poses` null: a static mesh; else the orders are made
 * for the key frames, and mesh->positions are those at rest. Every order holds all triangles. */
PELLUCID_API PellucidStatus pellucid_overdraw_mesh(const PellucidMesh* mesh, const PellucidPoses* poses,
                                                   const PellucidOverdrawOptions* options,
                                                   PellucidOrderSet** orders);

/* ------------------------------------------------------------------------------------- what is in an order
 * set */

PELLUCID_API void pellucid_free_order_set(PellucidOrderSet* orders);

PELLUCID_API uint32_t pellucid_order_count(const PellucidOrderSet* orders);

typedef enum PellucidDirection {
  pellucid_front_to_back = 0, /* for "under" blending, and for opaque meshes */
  pellucid_back_to_front = 1  /* for the usual "over" blending */
} PellucidDirection;

/* Indices of order 0 .. count - 1, or of PELLUCID_NO_ORDER: the best single order for all views, which is
 * drawn where the others do not hold. 0 for an order that is not there. */
PELLUCID_API uint64_t pellucid_order_index_count(const PellucidOrderSet* orders, uint32_t order);

/* Write these indices, three a triangle in drawing order, to `destination`, which has room for all of them:
 * plain memory or a mapped buffer, which is only written to. index_bytes 2 (for at most 65,535 vertices) or
 * 4. Overdraw orders are drawn front to back only. */
PELLUCID_API PellucidStatus pellucid_copy_order_indices(const PellucidOrderSet* orders, uint32_t order,
                                                        PellucidDirection direction, uint32_t index_bytes,
                                                        void* destination);

/* What pellucid/runtime/select.h needs in every frame: pellucid_select_perspective(&selector, world, eye).
 * Its arrays belong to the order set. Where no order holds it answers PELLUCID_NO_ORDER. */
PELLUCID_API PellucidStatus pellucid_order_selector(const PellucidOrderSet* orders, PellucidOrders* selector);

/* The same for orders with poses: pellucid_select_animated(&selector, &keyframes, time, world, eye). Count 0
 * where there are none (of orders from a file: unless it has one animation). Its arrays belong to the order
 * set. */
PELLUCID_API PellucidStatus pellucid_order_keyframes(const PellucidOrderSet* orders,
                                                     PellucidKeyframes* keyframes);

typedef struct PellucidOrderStatistics {
  uint64_t triangles;         /* of the mesh */
  uint64_t dropped_triangles; /* of these, left out because they draw nothing */
  uint64_t index_bytes;       /* of all orders, with 2 bytes an index where the vertices allow, else 4 */
  double measured_error;  /* transparency: wrong pixels from held-out viewpoints, share; -1: not measured */
  double violated_weight; /* transparency: share of the overlapped area that is drawn in the wrong order */
  double overdraw;        /* overdraw: shaded / visible fragments over the training views; else 0 */
  double seconds;         /* that it took; 0 for orders from a file */
} PellucidOrderStatistics;
PELLUCID_API PellucidStatus pellucid_order_statistics(const PellucidOrderSet* orders,
                                                      PellucidOrderStatistics* statistics,
                                                      size_t struct_size);

/* ----------------------------------------------------------------------------------------------- measures */

typedef enum PellucidCacheModel { pellucid_cache_fifo = 0, pellucid_cache_lru = 1 } PellucidCacheModel;

typedef struct PellucidCacheQuality {
  uint64_t misses;
  double acmr; /* misses per triangle: about 0.5 at best, 3 at worst */
  double atvr; /* misses per vertex that is used: 1 at best */
} PellucidCacheQuality;
/* Of an index buffer as it is drawn; cache_size >= 3. */
PELLUCID_API PellucidStatus pellucid_measure_cache(const void* indices, uint32_t index_bytes,
                                                   uint64_t index_count, uint32_t vertex_count,
                                                   PellucidCacheModel model, uint32_t cache_size,
                                                   PellucidCacheQuality* quality);

typedef struct PellucidMeasureOptions {
  size_t struct_size; /* set by init */
  PellucidRun run;
  uint32_t viewpoints;               /* at random: 100 */
  double min_distance, max_distance; /* of these, radii: 2 to 5 */
  uint32_t size;                     /* pixels a side, 512 */
  PellucidFacing facing; /* which faces are drawn (duplicated); orders of blending know it, those of overdraw
                            do not: say single where pellucid_overdraw_mesh() was told so */
  double alpha;          /* opacity of the pictures that the PSNR is of: 0.5 */
  uint64_t seed;
} PellucidMeasureOptions;
PELLUCID_API void pellucid_measure_options_init(PellucidMeasureOptions* options, size_t struct_size);

typedef struct PellucidBlendQuality {
  double ipr_mean, ipr_max;   /* share of covered pixels with a fragment out of depth order */
  double psnr_mean, psnr_min; /* dB over covered pixels, at most 100 */
} PellucidBlendQuality;
/* How right blending is: the orders of a set for this mesh, or null: the order in which the mesh is stored.
 */
PELLUCID_API PellucidStatus pellucid_measure_blending(const PellucidMesh* mesh,
                                                      const PellucidOrderSet* orders,
                                                      const PellucidMeasureOptions* options,
                                                      PellucidBlendQuality* quality);

typedef struct PellucidOverdrawQuality {
  double mean, max; /* over the pictures: fragments shaded / pixels covered, 1 at best */
} PellucidOverdrawQuality;
/* How much is shaded in vain, with a depth test. `orders` null: in the order in which the mesh is stored.
 * `poses` null: the mesh as it is; else those that the orders were made for. */
PELLUCID_API PellucidStatus pellucid_measure_overdraw(const PellucidMesh* mesh, const PellucidPoses* poses,
                                                      const PellucidOrderSet* orders,
                                                      const PellucidMeasureOptions* options,
                                                      PellucidOverdrawQuality* quality);

/* -------------------------------------------------------------------------------------------------- files */

/* A model file: read, ordered primitive by primitive, written as glTF. */
typedef struct PellucidModel PellucidModel;

/* glTF, GLB, PLY, OBJ, STL or OFF. */
PELLUCID_API PellucidStatus pellucid_read_model(const char* path, PellucidModel** model);
PELLUCID_API void pellucid_free_model(PellucidModel* model);

typedef enum PellucidAlphaMode {
  pellucid_alpha_opaque = 0,
  pellucid_alpha_mask = 1,
  pellucid_alpha_blend = 2
} PellucidAlphaMode;

typedef struct PellucidPrimitive {
  const char* name;             /* belongs to the model, as all below */
  PellucidMesh mesh;            /* in the primitive's own space */
  uint32_t double_sided;        /* 1: order it with pellucid_facing_duplicated */
  uint32_t deforms;             /* 1: skinned or morphed, static orders do not hold */
  PellucidAlphaMode alpha_mode; /* of formats without materials: blend */
  float base_color[4];          /* linear red green blue, and opacity */
  uint32_t has_orders;          /* 1: it has orders that pellucid_model_orders() gives */
} PellucidPrimitive;

/* What is ordered by itself and drawn by one call; points and lines are among them, with no triangle. */
PELLUCID_API uint32_t pellucid_primitive_count(const PellucidModel* model);
PELLUCID_API PellucidStatus pellucid_model_primitive(const PellucidModel* model, uint32_t primitive,
                                                     PellucidPrimitive* description, size_t struct_size);

/* A copy of the orders of a primitive: of the file, or those set since. pellucid_nothing_to_do: none. */
PELLUCID_API PellucidStatus pellucid_model_orders(const PellucidModel* model, uint32_t primitive,
                                                  PellucidOrderSet** orders);

/* Give a primitive these transparency orders, which are copied; null takes away those that it has. They must
 * have been made for its mesh, all of it and as it is. (Overdraw orders of files: `pellucid overdraw`.) */
PELLUCID_API PellucidStatus pellucid_model_set_orders(PellucidModel* model, uint32_t primitive,
                                                      const PellucidOrderSet* orders);

typedef enum PellucidEncoding {
  pellucid_encoding_indices = 0, /* plain index accessors */
  pellucid_encoding_patches = 1, /* permutations of triangle ids: a third of the size */
  pellucid_encoding_meshopt = 2  /* the same, compressed by EXT_meshopt_compression */
} PellucidEncoding;

typedef struct PellucidWriteOptions {
  size_t struct_size;          /* set by init */
  PellucidEncoding encoding;   /* indices */
  PellucidDirection direction; /* front_to_back */
  uint32_t split_buffer;       /* 1: orders go to OUT.orders.bin, beside the file */
  uint32_t keep_indices; /* 1: other viewers draw the stored order; 0: they draw the best single order */
} PellucidWriteOptions;
PELLUCID_API void pellucid_write_options_init(PellucidWriteOptions* options, size_t struct_size);

/* Write .glb or .gltf, by the extension of `path`, with the orders that the model has by now. Of a glTF all
 * else is kept. Files appear whole or not at all. docs/file-format.md is the format. */
PELLUCID_API PellucidStatus pellucid_write_model(const PellucidModel* model, const char* path,
                                                 const PellucidWriteOptions* options);

#ifdef __cplusplus
}
#endif

#endif /* PELLUCID_C_PELLUCID_H */
