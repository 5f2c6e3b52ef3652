// Tiles of 8 x 8 pixels that have pixels to be drawn anew. D has the arguments of an indirect dispatch with
// one workgroup per marked tile, one word per tile of the image (1: marked), and the list of marked tiles.
#ifndef MARKED_TILES_GLSL
#define MARKED_TILES_GLSL
layout(std430, set = 0, binding = SLOT_D) buffer MarkedTiles { uint marked_tiles[]; };

uvec2 tiles_of_image() { return (frame.size + 7u) / 8u; }
uint tile_count() { return tiles_of_image().x * tiles_of_image().y; }

bool is_marked_tile(uint tile) { return marked_tiles[3u + tile] != 0u; }

void mark_tile(uint tile) {
  if (atomicExchange(marked_tiles[3u + tile], 1u) != 0u) return;
  marked_tiles[3u + tile_count() + atomicAdd(marked_tiles[0], 1u)] = tile;
}

// Returns the position of the n-th marked tile among the tiles of the image.
uvec2 marked_tile(uint n) {
  const uint tile = marked_tiles[3u + tile_count() + n];
  return uvec2(tile % tiles_of_image().x, tile / tiles_of_image().x);
}
#endif
