// Order a mesh that a program made itself, and ask which buffer draws it from a camera.
#include <pellucid/sequencing.h>
#include <pellucid/transparency.h>

#include <cmath>
#include <iostream>

namespace {

// A torus: concave, so that one order does not serve all views.
pellucid::Mesh make_torus(std::uint32_t around, std::uint32_t across) {
  constexpr float kPi = 3.14159265F;
  pellucid::Mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const float u = 2 * kPi * static_cast<float>(i) / static_cast<float>(around);
      const float v = 2 * kPi * static_cast<float>(j) / static_cast<float>(across);
      const float radius = 1 + 0.4F * std::cos(v);
      mesh.positions.push_back({radius * std::cos(u), radius * std::sin(u), 0.4F * std::sin(v)});
      const std::uint32_t next_i = (i + 1) % around;
      const std::uint32_t next_j = (j + 1) % across;
      const std::uint32_t a = i * across + j;
      const std::uint32_t b = next_i * across + j;
      const std::uint32_t c = next_i * across + next_j;
      const std::uint32_t d = i * across + next_j;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

}  // namespace

int main() {
  try {
    const pellucid::Mesh mesh = make_torus(24, 8);
    pellucid::OrderOptions options;
    options.partition = pellucid::parse_partition("S1,1");
    const pellucid::OrderResult result = pellucid::order_mesh(mesh, options);
    const std::uint32_t order = pellucid::select_order(result.orders, {0.3, -0.2, 0.9});
    std::cout << mesh.triangles.size() << " triangles, " << result.orders.orders.size()
              << " buffers, from above draw buffer " << order << " ("
              << pellucid::index_buffer(mesh, result.orders.orders[order]).size() << " indices)\n";
    return 0;
  } catch (const pellucid::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
