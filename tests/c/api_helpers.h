// Makes meshes and handles for the tests of the C interface.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "pellucid/c/pellucid.h"

namespace pellucid::testing {

struct OrderSetDeleter {
  void operator()(PellucidOrderSet* set) const { pellucid_free_order_set(set); }
};
using OrderSetHandle = std::unique_ptr<PellucidOrderSet, OrderSetDeleter>;

struct ModelDeleter {
  void operator()(PellucidModel* model) const { pellucid_free_model(model); }
};
using ModelHandle = std::unique_ptr<PellucidModel, ModelDeleter>;

struct Arrays {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  [[nodiscard]] PellucidMesh mesh() const {
    return {positions.data(),
            static_cast<std::uint32_t>(positions.size() / 3),
            0,
            indices.data(),
            4,
            static_cast<std::uint32_t>(indices.size() / 3)};
  }
};

// A torus overlaps itself, so that one order does not serve all views.
inline Arrays torus(std::uint32_t around = 16, std::uint32_t across = 8) {
  constexpr float kTwoPi = 6.2831853F;
  Arrays arrays;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const float u = kTwoPi * static_cast<float>(i) / static_cast<float>(around);
      const float v = kTwoPi * static_cast<float>(j) / static_cast<float>(across);
      const float radius = 1 + 0.4F * std::cos(v);
      for (const float value : {radius * std::cos(u), radius * std::sin(u), 0.4F * std::sin(v)})
        arrays.positions.push_back(value);
      const std::uint32_t next_i = (i + 1) % around;
      const std::uint32_t next_j = (j + 1) % across;
      const std::uint32_t a = i * across + j;
      const std::uint32_t b = next_i * across + j;
      const std::uint32_t c = next_i * across + next_j;
      const std::uint32_t d = i * across + next_j;
      arrays.indices.insert(arrays.indices.end(), {a, b, c, a, c, d});
    }
  }
  return arrays;
}

// Few views, and no images to measure errors in: quick.
inline PellucidOrderOptions quick_options() {
  PellucidOrderOptions options;
  pellucid_order_options_init(&options, sizeof options);
  options.views = "S1,1";
  options.method = pellucid_method_acyclic;
  return options;
}

inline OrderSetHandle ordered(const PellucidMesh& mesh, const PellucidOrderOptions& options) {
  PellucidOrderSet* set = nullptr;
  EXPECT_EQ(pellucid_order_mesh(&mesh, &options, &set), pellucid_ok) << pellucid_last_error();
  return OrderSetHandle(set);
}

inline std::vector<std::uint32_t> indices_of(const PellucidOrderSet* set, std::uint32_t order,
                                             PellucidDirection direction = pellucid_front_to_back) {
  std::vector<std::uint32_t> indices(pellucid_order_index_count(set, order));
  EXPECT_EQ(pellucid_copy_order_indices(set, order, direction, 4, indices.data()), pellucid_ok)
      << pellucid_last_error();
  return indices;
}

}  // namespace pellucid::testing
