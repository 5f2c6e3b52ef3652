/* A minimal engine: one pipeline that blends, one vertex buffer, one index buffer, and one render target. */
#ifndef ENGINE_H
#define ENGINE_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

enum { kWidth = 480, kHeight = 480 };

typedef struct Buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
  void* mapped;
} Buffer;

typedef struct Engine {
  VkInstance instance;
  VkPhysicalDevice gpu;
  VkDevice device;
  VkQueue queue;
  uint32_t queue_family;
  VkCommandPool pool;
  VkCommandBuffer commands;
  VkFence done;
  VkImage target;
  VkDeviceMemory target_memory;
  VkImageView target_view;
  VkPipelineLayout layout;
  VkPipeline pipeline;
  Buffer vertices, indices, pixels;
} Engine;

/* The push constants of a frame. */
typedef struct Frame {
  float clip_from_world[16]; /* column-major */
  float eye[4];
} Frame;

/* Makes an engine. Vertices are six floats: position and normal. Where Vulkan fails, the program ends. */
Engine make_engine(const void* vertices, size_t vertex_bytes, size_t index_bytes);
void free_engine(Engine* engine);

/* Draws indices first .. first + count - 1 of the index buffer, blended "over" a white background in this
 * order. Returns kHeight rows of kWidth RGBA pixels, which the next call overwrites. */
const uint8_t* draw(Engine* engine, const Frame* frame, uint32_t first, uint32_t count);

#endif
