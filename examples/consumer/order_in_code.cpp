// Orders a translucent mesh that the program made itself, and draws it from three cameras. In the place of a
// renderer, this program prints.
#include <pellucid/pellucid.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <vector>

namespace {

struct Renderer {
  void upload(const std::vector<std::byte>& bytes, std::uint32_t bytes_per_index) {
    std::cout << "uploads " << bytes.size() / bytes_per_index << " indices of " << bytes_per_index
              << " bytes\n";
  }
  void draw_indexed(const pellucid::IndexRange& range, bool is_fallback) {
    std::cout << "draws indices " << range.first << " .. " << range.first + range.count - 1
              << (is_fallback ? ", the fallback\n" : "\n");
  }
};

// The README shows this class; tests/api/readme_example.cmake compares the two.
// A translucent mesh: its orders are made once, and one of them is chosen in every frame.
class TranslucentMesh {
 public:
  TranslucentMesh(const std::vector<pellucid::Vec3f>& positions, const std::vector<std::uint32_t>& indices,
                  Renderer& renderer)
      : orders_(pellucid::order({positions, indices}, {.max_error = 0.001})),
        buffer_(orders_.index_buffer(pellucid::SortDirection::back_to_front)) {
    renderer.upload(buffer_.bytes, buffer_.bytes_per_index);  // all orders; the vertices stay as they are
  }

  void draw(const pellucid::Mat4& world_from_mesh, const pellucid::Vec3d& camera, Renderer& renderer) const {
    const pellucid::DrawOrder order = orders_.select(world_from_mesh, camera);
    renderer.draw_indexed(buffer_.range(order), order.is_fallback);  // blended, with back faces culled
  }

 private:
  pellucid::OrderedMesh orders_;
  pellucid::IndexBuffer buffer_;
};

// A torus: it overlaps itself, so that one order does not serve all views.
void make_torus(std::vector<pellucid::Vec3f>& positions, std::vector<std::uint32_t>& indices) {
  constexpr std::uint32_t kAround = 24;
  constexpr std::uint32_t kAcross = 8;
  constexpr float kTwoPi = 6.2831853F;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const float u = kTwoPi * static_cast<float>(i) / kAround;
      const float v = kTwoPi * static_cast<float>(j) / kAcross;
      const float radius = 1 + 0.4F * std::cos(v);
      positions.push_back({radius * std::cos(u), radius * std::sin(u), 0.4F * std::sin(v)});
      const std::uint32_t next_i = (i + 1) % kAround;
      const std::uint32_t next_j = (j + 1) % kAcross;
      const std::uint32_t a = i * kAcross + j;
      const std::uint32_t b = next_i * kAcross + j;
      const std::uint32_t c = next_i * kAcross + next_j;
      const std::uint32_t d = i * kAcross + next_j;
      indices.insert(indices.end(), {a, b, c, a, c, d});
    }
  }
}

}  // namespace

int main() {
  try {
    std::vector<pellucid::Vec3f> positions;
    std::vector<std::uint32_t> indices;
    make_torus(positions, indices);
    Renderer renderer;
    const TranslucentMesh torus(positions, indices, renderer);
    // From above, from the side, and from inside the hole, where the fallback is drawn.
    const pellucid::Mat4 world_from_mesh;
    for (const pellucid::Vec3d& camera : {pellucid::Vec3d{0.5, 0, 4}, {4, 1, 0.5}, {0, 0, 0.1}})
      torus.draw(world_from_mesh, camera, renderer);
    return 0;
  } catch (const pellucid::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
