/* The mesh that is drawn: a chain of three links, made here so that the example needs no file. */
#ifndef SHAPE_H
#define SHAPE_H

#include <math.h>
#include <stdint.h>

enum {
  kLinks = 3,
  kAlong = 64,
  kAcross = 14,
  kVertices = kLinks * kAlong * kAcross,
  kTriangles = 2 * kVertices
};

typedef struct Vertex {
  float position[3], normal[3];
} Vertex;

typedef struct Shape {
  Vertex vertices[kVertices];
  uint32_t triangles[kTriangles][3];
} Shape;

/* Returns a vertex of a torus around z, or around -y for every other link, so that each link hangs in the
 * next. */
static inline Vertex link_vertex(int link, double u, double v) {
  const double normal[3] = {cos(v) * cos(u), cos(v) * sin(u), sin(v)};
  const double ring[3] = {1.5 * cos(u), 1.5 * sin(u), 0};
  const int turned = link % 2;
  Vertex vertex;
  int k;
  for (k = 0; k < 3; ++k) {
    const int from = turned && k > 0 ? 3 - k : k;
    const double sign = turned && k == 1 ? -1 : 1;
    vertex.normal[k] = (float)(sign * normal[from]);
    vertex.position[k] = (float)(sign * (ring[from] + 0.4 * normal[from]));
  }
  vertex.position[0] += (float)(1.9 * (link - 1));
  return vertex;
}

static inline void make_chain(Shape* shape) {
  const double turn = 6.283185307179586;
  uint32_t link, i, j;
  for (link = 0; link < kLinks; ++link)
    for (i = 0; i < kAlong; ++i)
      for (j = 0; j < kAcross; ++j) {
        const uint32_t row = (link * kAlong + i) * kAcross,
                       next = (link * kAlong + (i + 1) % kAlong) * kAcross;
        const uint32_t a = row + j, b = next + j, c = next + (j + 1) % kAcross, d = row + (j + 1) % kAcross;
        uint32_t* t = shape->triangles[2 * a];
        shape->vertices[a] = link_vertex((int)link, turn * i / kAlong, turn * j / kAcross);
        t[0] = t[3] = a;
        t[1] = b;
        t[2] = t[4] = c;
        t[5] = d;
      }
}

#endif
