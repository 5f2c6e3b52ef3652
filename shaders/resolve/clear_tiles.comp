#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "resolve/tiles.glsl"
// Empties all classes of tiles. The other two words of each indirect dispatch are 1.
layout(local_size_x = 1) in;
void main() {
  for (uint i = 0u; i < kClasses; ++i) {
    tiles[3u * i] = 0u;
    tiles[3u * i + 1u] = 1u;
    tiles[3u * i + 2u] = 1u;
  }
}
