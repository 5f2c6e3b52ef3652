/* pellucid/c/pellucid.h - the C interface of pellucid, for C99 and for every language that can call C.
 *
 * In: triangle meshes as arrays, or model files. Out: order sets, each of which is a few draw orders of a
 * mesh and the table that says which of them to draw for which camera. It wraps the C++ interface,
 * pellucid/pellucid.h. Link libpellucid.so (CMake: find_package(pellucid COMPONENTS c), pellucid::c;
 * pkg-config: pellucid-c). docs/c-api.md is the guide.
 *
 * CONVENTIONS
 *   Shapes     Positions are x y z as floats. A triangle has three indices, counter-clockwise seen from
 *              its front.
 *   Space      Right-handed. Directions and eyes are in the mesh's own space. Distances of cameras are in
 *              radii of the mesh's bounding sphere, whose centre is that of the bounding box. Ratios are
 *              plain numbers.
 *   Status     A function that can fail returns a PellucidStatus. When it fails, its result is null or
 *              unchanged, and pellucid_last_error() gives the reason in one line. Other functions cannot
 *              fail for valid handles.
 *   Ownership  Arrays that you pass are copied and remain yours. Each handle is freed by its
 *              pellucid_free_*() function, together with everything that belongs to the handle. Freeing
 *              null does nothing.
 *   Options    Call the init function first, then change members. A comment names the default of its
 *              member. A null pointer to options means all defaults. The size that the init function
 *              takes is `sizeof` the structure: a program keeps working with later libraries, whose
 *              structures may have more members at the end.
 *   Threads    All functions may be called from several threads at once. An order set never changes, so
 *              threads may share it. Several threads may read a model while no thread changes it.
 *   Results    The same input, options and seed give the same result, for any number of threads.
 *   Effects    The library changes no signal handler and no global variable, and prints nothing. No C++
 *              exception leaves it. */
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
  pellucid_bad_argument = 1,  /* an argument is null or out of range, or options contradict each other */
  pellucid_bad_input = 2,     /* a file is missing, truncated, damaged, or not what it claims to be */
  pellucid_nothing_to_do = 3, /* the input is valid, but has no triangle, or no orders */
  pellucid_cannot_write = 4,  /* no permission, disk full */
  pellucid_cancelled = 5,     /* the progress function asked for it */
  pellucid_out_of_memory = 6,
  pellucid_internal = 7 /* a bug in pellucid */
} PellucidStatus;

/* Returns why the last failing call of this thread failed, with the file or the argument. Empty before the
 * first failure. The text is valid until this thread's next failing call. */
PELLUCID_API const char* pellucid_last_error(void);

/* Returns the version of the library that is linked at run time, such as "0.1.0". */
PELLUCID_API const char* pellucid_version(void);

/* ---------------------------------------------------------------------------------------------- progress */

/* The type of your progress function. A long call calls it at the beginning of every stage, and then at
 * most every 20 ms. It may be called from any thread, but never from two at once. `stage` is valid during
 * the call only. `total` is 0 if the amount of work is not known. Return 0 to go on; any other value ends
 * the long call soon with pellucid_cancelled. The function must not throw and must not call longjmp(). */
typedef int (*PellucidProgress)(void* user, const char* stage, uint64_t done, uint64_t total);

/* Part of the options of every long call. */
typedef struct PellucidRun {
  PellucidProgress progress; /* default null: progress is not reported */
  void* user;                /* is passed to `progress` */
  uint32_t threads;          /* default 0: one per core; limits the whole process during the call */
} PellucidRun;

/* ------------------------------------------------------------------------------------------------ meshes */

/* A mesh. Transparency orders leave out triangles that draw nothing: those with an index >= vertex_count,
 * with a corner that is NaN or infinite, or without area. Overdraw orders contain all triangles, and an
 * index out of range is an error. */
typedef struct PellucidMesh {
  const float* positions; /* x y z of every vertex */
  uint32_t vertex_count;
  uint32_t position_stride; /* bytes from one vertex to the next, a multiple of 4; 0 means 12 */
  const void* indices;      /* three for every triangle */
  uint32_t index_bytes;     /* 2 or 4 */
  uint32_t triangle_count;
} PellucidMesh;

/* ------------------------------------------------------------------------------------ transparency orders */

/* Draw orders of a mesh, and the table that says which of them to draw for which camera. */
typedef struct PellucidOrderSet PellucidOrderSet;

typedef enum PellucidMethod {
  pellucid_method_budget = 0, /* as few orders as were found with a measured error of at most max_error */
  pellucid_method_acyclic = 1 /* the method of the paper In-Depth Buffers */
} PellucidMethod;

typedef enum PellucidFacing {
  /* Both sides are visible. Orders contain flipped copies of triangles: draw them with back faces culled. */
  pellucid_facing_duplicated = 0,
  pellucid_facing_single = 1 /* only front faces are visible: draw with back faces culled */
} PellucidFacing;

typedef struct PellucidOrderOptions {
  size_t struct_size; /* set by init */
  PellucidRun run;
  PellucidMethod method; /* default: budget */
  PellucidFacing facing; /* default: duplicated */
  const char* views;     /* view cells: "S2,2" (default, 320 cells), "S1,1", "P2", "T2", ... */
  /* Distances of the sampled cameras, in radii, 1 or more; HUGE_VAL is orthographic. Default null: those of
   * default_distances() in pellucid/transparency.h. */
  const double* distances;
  uint32_t distance_count;
  double max_error;     /* budget: largest share of wrong pixels; default 0.001 */
  uint32_t max_buffers; /* budget: largest number of orders; default 16 */
  uint32_t min_buffers; /* budget: least number of orders, except that unused ones are removed; default 1 */
  double tolerance;     /* overlaps thinner than this many radii do not count; default < 0: by method */
  double alpha;         /* opacity that weights occlusions, 0..1; default 0: by their area alone */
  uint32_t cache_size;  /* entries of the FIFO vertex cache to optimise for; 0: none; default 20 */
  /* Simplify the mesh to this many triangles, order that, and carry the orders over. 0: never. Default
   * UINT32_MAX: to 10,000 triangles if the mesh has more than 24,000. */
  uint32_t upsample_from;
  uint64_t memory; /* memory budget in bytes; default 0: no limit */
  uint64_t seed;   /* default 1 */
} PellucidOrderOptions;
/* Sets all members to their defaults. */
PELLUCID_API void pellucid_order_options_init(PellucidOrderOptions* options, size_t struct_size);

/* Orders a static mesh for blending. This takes seconds to minutes, about linear in triangles up to
 * 24,000. */
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
  PellucidOverdrawMethod method; /* default: refined */
  PellucidFacing facing; /* single (default): back faces are culled; duplicated: both sides are drawn */
  uint32_t buffers;      /* number of orders; default 5; 1 is often enough for a mesh without poses */
  /* Default 0.85. Larger: less overdraw and more cache misses. 3: every triangle is a patch. */
  double lambda;
  uint32_t cache_size;               /* entries of the FIFO vertex cache; default 16 */
  uint32_t view_level;               /* n, for 10 * 4^n + 2 viewpoints; at most 5; default 2 */
  double min_distance, max_distance; /* of these viewpoints, in radii; default 1.5 and 3 */
  uint32_t size; /* pixels per side of the images in which overdraw is counted; default 256 */
  uint64_t seed; /* default 1 */
} PellucidOverdrawOptions;
/* Sets all members to their defaults. */
PELLUCID_API void pellucid_overdraw_options_init(PellucidOverdrawOptions* options, size_t struct_size);

/* Key frames of an animated mesh. */
typedef struct PellucidPoses {
  const float* const* positions; /* for every key frame, laid out as PellucidMesh::positions */
  const float* times;            /* seconds, strictly increasing */
  uint32_t frame_count;
} PellucidPoses;

/* Orders an opaque mesh to reduce overdraw: the depth test then rejects most hidden fragments before they
 * are shaded. With `poses` the orders are for these key frames, and mesh->positions is the mesh at rest;
 * null means a static mesh. Every order contains all triangles. */
PELLUCID_API PellucidStatus pellucid_overdraw_mesh(const PellucidMesh* mesh, const PellucidPoses* poses,
                                                   const PellucidOverdrawOptions* options,
                                                   PellucidOrderSet** orders);

/* ----------------------------------------------------------------------------- contents of an order set */

PELLUCID_API void pellucid_free_order_set(PellucidOrderSet* orders);

/* Returns the number of orders, without PELLUCID_NO_ORDER; 0 for null. */
PELLUCID_API uint32_t pellucid_order_count(const PellucidOrderSet* orders);

/* In which direction the triangles of an order are stored or drawn. */
typedef enum PellucidDirection {
  pellucid_front_to_back = 0, /* for "under" blending and for opaque meshes */
  pellucid_back_to_front = 1  /* for the usual "over" blending */
} PellucidDirection;

/* Returns the number of indices of order 0 .. count - 1, or of PELLUCID_NO_ORDER. The latter is the best
 * single order for all views, which is drawn if the others are not valid for a camera. It contains every
 * triangle once, as it is stored: if both sides of the mesh are visible, draw it without culling. Returns
 * 0 for an order that does not exist. */
PELLUCID_API uint64_t pellucid_order_index_count(const PellucidOrderSet* orders, uint32_t order);

/* Writes these indices, three for each triangle in draw order, to `destination`, which must have room for
 * all of them. It may be a mapped buffer, because it is only written to. index_bytes is 2 (for at most
 * 65,535 vertices) or 4. Overdraw orders are drawn front to back only. */
PELLUCID_API PellucidStatus pellucid_copy_order_indices(const PellucidOrderSet* orders, uint32_t order,
                                                        PellucidDirection direction, uint32_t index_bytes,
                                                        void* destination);

/* Writes what pellucid/runtime/select.h needs in every frame to `selector`: then
 * pellucid_select_perspective(&selector, world, eye) returns the order to draw, or PELLUCID_NO_ORDER if
 * none is valid for this camera. The arrays belong to the order set. */
PELLUCID_API PellucidStatus pellucid_order_selector(const PellucidOrderSet* orders, PellucidOrders* selector);

/* Writes the key frames of orders with poses to `keyframes`: then pellucid_select_animated(&selector,
 * &keyframes, time, world, eye) returns the order to draw. The count is 0 without poses, and for orders
 * from a file with several animations. The arrays belong to the order set. */
PELLUCID_API PellucidStatus pellucid_order_keyframes(const PellucidOrderSet* orders,
                                                     PellucidKeyframes* keyframes);

/* What ordering found, and how good the orders are. */
typedef struct PellucidOrderStatistics {
  uint64_t triangles;         /* of the mesh */
  uint64_t dropped_triangles; /* left out because they draw nothing */
  uint64_t index_bytes;       /* of all orders; an index has 2 bytes for at most 65,535 vertices, else 4 */
  double measured_error;      /* transparency: share of wrong pixels, held-out viewpoints; -1: unknown */
  double violated_weight; /* transparency: share of the overlapped area that is drawn in the wrong order */
  double overdraw;        /* overdraw: fragments shaded for each covered pixel, training views */
  double seconds;         /* that ordering took; 0 for orders from a file */
} PellucidOrderStatistics;
/* Writes the statistics of an order set. struct_size is sizeof(PellucidOrderStatistics). */
PELLUCID_API PellucidStatus pellucid_order_statistics(const PellucidOrderSet* orders,
                                                      PellucidOrderStatistics* statistics,
                                                      size_t struct_size);

/* ----------------------------------------------------------------------------------------------- measures */

typedef enum PellucidCacheModel { pellucid_cache_fifo = 0, pellucid_cache_lru = 1 } PellucidCacheModel;

typedef struct PellucidCacheQuality {
  uint64_t misses;
  double acmr; /* misses per triangle: about 0.5 at best, 3 at worst */
  double atvr; /* misses per used vertex: 1 at best */
} PellucidCacheQuality;
/* Simulates the vertex cache for an index buffer as it is drawn. cache_size must be 3 or more. */
PELLUCID_API PellucidStatus pellucid_measure_cache(const void* indices, uint32_t index_bytes,
                                                   uint64_t index_count, uint32_t vertex_count,
                                                   PellucidCacheModel model, uint32_t cache_size,
                                                   PellucidCacheQuality* quality);

typedef struct PellucidMeasureOptions {
  size_t struct_size; /* set by init */
  PellucidRun run;
  uint32_t viewpoints;               /* number of random viewpoints; default 100 */
  double min_distance, max_distance; /* of these, in radii; default 2 and 5 */
  uint32_t size;                     /* pixels per side; default 512 */
  /* Which faces are drawn; default: duplicated. It is ignored for transparency orders, which have their own.
   * For overdraw orders, use the value that pellucid_overdraw_mesh() was given. */
  PellucidFacing facing;
  double alpha; /* opacity of the faces in the images that the PSNR compares; default 0.5 */
  uint64_t seed;
} PellucidMeasureOptions;
/* Sets all members to their defaults. */
PELLUCID_API void pellucid_measure_options_init(PellucidMeasureOptions* options, size_t struct_size);

typedef struct PellucidBlendQuality {
  double ipr_mean, ipr_max;   /* share of covered pixels with a fragment out of order, mean and worst view */
  double psnr_mean, psnr_min; /* dB over covered pixels, at most 100 */
} PellucidBlendQuality;
/* Measures how well a mesh is blended by its orders or, if `orders` is null, by the order in which it is
 * stored. */
PELLUCID_API PellucidStatus pellucid_measure_blending(const PellucidMesh* mesh,
                                                      const PellucidOrderSet* orders,
                                                      const PellucidMeasureOptions* options,
                                                      PellucidBlendQuality* quality);

typedef struct PellucidOverdrawQuality {
  double mean, max; /* over the images: fragments shaded / pixels covered, 1 at best */
} PellucidOverdrawQuality;
/* Measures the overdraw of a mesh that is drawn with a depth test by its orders or, if `orders` is null,
 * by the order in which it is stored. `poses` are those that the orders were made for; null: the mesh as
 * it is. */
PELLUCID_API PellucidStatus pellucid_measure_overdraw(const PellucidMesh* mesh, const PellucidPoses* poses,
                                                      const PellucidOrderSet* orders,
                                                      const PellucidMeasureOptions* options,
                                                      PellucidOverdrawQuality* quality);

/* -------------------------------------------------------------------------------------------------- files */

/* A model from a file. Its primitives are ordered one by one, and it is written as glTF. */
typedef struct PellucidModel PellucidModel;

/* Reads glTF, GLB, PLY, OBJ, STL or OFF. */
PELLUCID_API PellucidStatus pellucid_read_model(const char* path, PellucidModel** model);
PELLUCID_API void pellucid_free_model(PellucidModel* model);

typedef enum PellucidAlphaMode {
  pellucid_alpha_opaque = 0,
  pellucid_alpha_mask = 1,
  pellucid_alpha_blend = 2
} PellucidAlphaMode;

typedef struct PellucidPrimitive {
  const char* name;             /* belongs to the model, as do all members */
  PellucidMesh mesh;            /* in the primitive's own space */
  uint32_t double_sided;        /* 1: order it with pellucid_facing_duplicated */
  uint32_t deforms;             /* 1: skinned or morphed, static orders do not hold */
  PellucidAlphaMode alpha_mode; /* blend for formats without materials */
  float base_color[4];          /* linear red, green, blue, and opacity */
  uint32_t has_orders;          /* 1: pellucid_model_orders() gives its orders */
} PellucidPrimitive;

/* Returns the number of primitives. A primitive is ordered by itself and drawn by one call. Points and lines
 * are primitives without triangles. */
PELLUCID_API uint32_t pellucid_primitive_count(const PellucidModel* model);
/* Describes a primitive. struct_size is sizeof(PellucidPrimitive). */
PELLUCID_API PellucidStatus pellucid_model_primitive(const PellucidModel* model, uint32_t primitive,
                                                     PellucidPrimitive* description, size_t struct_size);

/* Writes a new order set to `orders`: a copy of the orders of a primitive, which came from the file or were
 * set later. Returns pellucid_nothing_to_do if the primitive has none. */
PELLUCID_API PellucidStatus pellucid_model_orders(const PellucidModel* model, uint32_t primitive,
                                                  PellucidOrderSet** orders);

/* Replaces the orders of a primitive by a copy of these transparency orders, which must have been made for
 * its whole, unchanged mesh. Null removes the orders that it has. (For overdraw orders of files, use the
 * command line.) */
PELLUCID_API PellucidStatus pellucid_model_set_orders(PellucidModel* model, uint32_t primitive,
                                                      const PellucidOrderSet* orders);

typedef enum PellucidEncoding {
  pellucid_encoding_indices = 0, /* plain index accessors */
  pellucid_encoding_patches = 1, /* permutations of triangle numbers, with a third of the size of indices */
  pellucid_encoding_meshopt = 2  /* permutations, compressed by EXT_meshopt_compression */
} PellucidEncoding;

typedef struct PellucidWriteOptions {
  size_t struct_size;          /* set by init */
  PellucidEncoding encoding;   /* default: indices */
  PellucidDirection direction; /* default: front_to_back */
  uint32_t split_buffer;       /* 1: orders go to NAME.orders.bin, beside the file; default 0 */
  /* What viewers that do not know the extension draw. 0 (default): the best single order; 1: the stored
   * order. */
  uint32_t keep_indices;
} PellucidWriteOptions;
/* Sets all members to their defaults. */
PELLUCID_API void pellucid_write_options_init(PellucidWriteOptions* options, size_t struct_size);

/* Writes .glb or .gltf, by the extension of `path`, with the orders that the model has now. Everything
 * else in a glTF stays as it was. Files appear whole or not at all. The format is in docs/file-format.md. */
PELLUCID_API PellucidStatus pellucid_write_model(const PellucidModel* model, const char* path,
                                                 const PellucidWriteOptions* options);

#ifdef __cplusplus
}
#endif

#endif /* PELLUCID_C_PELLUCID_H */
