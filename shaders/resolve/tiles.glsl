// Lists of tiles of 8 x 8 pixels by class. E has three words of an indirect dispatch for each class, then the
// tiles of each class.
#ifndef TILES_GLSL
#define TILES_GLSL
const uint kClasses = 5u;
layout(std430, set = 0, binding = SLOT_E) buffer Tiles { uint tiles[]; };

uint class_of(uint longest) { 
  return longest <= 4u ? 0u : longest <= 8u ? 1u : longest <= 16u ? 2u : longest <= 128u ? 3u : 4u;
}

void put_tile(uint tile_class, uint tile, uint tile_count) {
  const uint place = atomicAdd(tiles[3u * tile_class], 1u);
  tiles[3u * kClasses + tile_class * tile_count + place] = tile;
}
uint tile_at(uint tile_class, uint place, uint tile_count) { return tiles[3u * kClasses + tile_class * tile_count + place]; }
#endif
