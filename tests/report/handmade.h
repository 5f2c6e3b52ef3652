// Makes small reports by hand for the tests of the module `report`.
#pragma once

#include <string>

#include "pellucid/report.h"

namespace pellucid::testing {

inline Mesh two_triangles() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// Both triangles, front and back, for all 20 cells of S0.
inline OrderSet two_orders() {
  OrderSet orders;
  orders.partition = parse_partition("S0,0");
  orders.sphere = bounding_sphere(two_triangles());
  orders.valid_from = 1.25;
  orders.orders = {{node_of(0, false), node_of(1, false)}, {node_of(1, true), node_of(0, true)}};
  orders.cell_orders.assign(20, 0);
  for (std::size_t cell = 10; cell < 20; ++cell) orders.cell_orders[cell] = 1;
  orders.base_sequence = {0, 1};
  return orders;
}

inline MethodReport method(const std::string& name, MethodKind kind, double ipr) {
  MethodReport report;
  report.kind = kind;
  report.buffers = kind == MethodKind::orders ? 2 : 1;
  report.memory_bytes = 48;
  report.fifo = {4, 8, 2.0, 2.0};
  report.atvr = 1.5;
  report.overdraw = 1.25;
  report.quality.name = name;
  report.quality.ipr_mean = ipr;
  report.quality.ipr_max = 2 * ipr;
  report.quality.psnr_mean = 50;
  report.quality.psnr_min = 40;
  report.quality.by_distance = {{3.5, ipr, 50}, {5, ipr, 50}};
  for (int i = 0; i < 12; ++i)
    report.quality.frames.push_back(
        {.foreground = 1000, .incorrect = static_cast<std::uint64_t>(1000 * ipr), .squared_error = 0.1});
  return report;
}

inline MeasureReport measured(const std::string& primitive_name) {
  MeasureReport report;
  report.inputs = {"a.glb"};
  report.settings.viewpoints = 12;
  report.settings.size = 64;
  report.overdraw_viewpoints = 12;
  PrimitiveMeasureReport primitive;
  primitive.name = primitive_name;
  primitive.triangles = 2;
  primitive.vertices = 4;
  primitive.methods = {method("a", MethodKind::orders, 0.01), method("original", MethodKind::baseline, 0.25),
                       method("centroid_sort", MethodKind::baseline, 0.05)};
  report.primitives = {primitive};
  return report;
}

}  // namespace pellucid::testing
