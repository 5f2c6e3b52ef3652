// Tests the C++ interface in memory: the arrays of the caller, index buffers, and the choice of an order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "meshes.h"
#include "pellucid/pellucid.h"
#include "pellucid/runtime/select.h"

namespace pellucid {
namespace {

using ::testing::HasSubstr;
using testing::kNaN;

struct Arrays {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
};

// Two shells, one inside the other, so that one order does not serve all views.
Arrays shells() {
  Mesh mesh = testing::icosphere_mesh(1);
  testing::append(mesh, testing::icosphere_mesh(1, 0.6, {0.2, 0, 0}));
  Arrays arrays{mesh.positions, {}};
  for (const Triangle& t : mesh.triangles) arrays.indices.insert(arrays.indices.end(), t.begin(), t.end());
  return arrays;
}

// Few views and no images to judge by: quick.
OrderOptions quick() {
  OrderOptions options;
  options.method = OrderMethod::acyclic;
  options.partition = parse_partition("S1,1");
  return options;
}

OverdrawOptions quick_overdraw() {
  OverdrawOptions options;
  options.buffers = 2;
  options.view_level = 1;
  options.size = 64;
  return options;
}

OrderedMesh ordered_shells(const OrderOptions& options = quick()) {
  const Arrays arrays = shells();
  return order({arrays.positions, arrays.indices}, options);
}

std::vector<std::uint32_t> indices_of(const IndexBuffer& buffer, const IndexRange& range) {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
    std::uint32_t wide = 0;
    std::uint16_t narrow = 0;
    const std::byte* at = buffer.bytes.data() + std::size_t{i} * buffer.bytes_per_index;
    if (buffer.bytes_per_index == 2) {
      std::memcpy(&narrow, at, sizeof narrow);
      wide = narrow;
    } else {
      std::memcpy(&wide, at, sizeof wide);
    }
    indices.push_back(wide);
  }
  return indices;
}

std::vector<std::uint32_t> indices_of(const OrderedMesh& mesh, std::uint32_t index,
                                      SortDirection direction = SortDirection::front_to_back) {
  std::vector<std::uint32_t> indices(mesh.index_count({index, false}));
  mesh.copy_indices({index, false}, direction, indices);
  return indices;
}

template <class Call>
ErrorKind kind_of_error(const Call& call, const std::string& text = "") {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(text));
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

// Mirrored, scaled and moved.
Mat4 random_world(Random& random) {
  Mat4 world;
  for (std::size_t i = 0; i < 16; ++i) {
    if (i % 4 != 3) world.m[i] = random.uniform(-2, 2);
  }
  return world;
}

Vec3d transformed(const Mat4& world, const Vec3d& p) {
  const auto row = [&](std::size_t r) {
    return world.m[r] * p.x + world.m[4 + r] * p.y + world.m[8 + r] * p.z + world.m[12 + r];
  };
  return {row(0), row(1), row(2)};
}

// ---------------------------------------------------------------------------------------- the caller's
// arrays

TEST(FrontDoor, RefusesIndicesThatDoNotFit) {
  Arrays arrays = shells();
  arrays.indices[7] = 84;
  const auto call = [&] { order({arrays.positions, arrays.indices}, quick()); };
  EXPECT_EQ(kind_of_error(call, "triangle 2 has the index 84, but there are 84 vertices"),
            ErrorKind::bad_argument);
  EXPECT_EQ(kind_of_error(
                [&] {
                  reduce_overdraw({arrays.positions, arrays.indices});
                },
                "index 84"),
            ErrorKind::bad_argument);
  arrays.indices.pop_back();
  EXPECT_EQ(kind_of_error(call, "not a multiple of 3"), ErrorKind::bad_argument);
}

TEST(FrontDoor, RefusesPositionsThatCannotBeRead) {
  const std::vector<float> floats(7);
  const std::vector<std::uint32_t> none;
  EXPECT_EQ(kind_of_error([&] { copy_mesh({floats, none}); }, "7 floats"), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of_error([] { PositionView(nullptr, 1); }, "null"), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of_error([&] { PositionView(floats.data(), 1, 10); }, "stride"), ErrorKind::bad_argument);
}

TEST(FrontDoor, TakesEveryLayoutOfTheSameMesh) {
  const Arrays arrays = shells();
  const std::vector<std::uint16_t> narrow(arrays.indices.begin(), arrays.indices.end());
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < arrays.indices.size(); i += 3)
    triangles.push_back({arrays.indices[i], arrays.indices[i + 1], arrays.indices[i + 2]});
  std::vector<float> packed;
  std::vector<float> interleaved;
  for (const Vec3f& p : arrays.positions) {
    packed.insert(packed.end(), {p.x, p.y, p.z});
    interleaved.insert(interleaved.end(), {p.x, p.y, p.z, 7, 8});
  }
  const Mesh expected{arrays.positions, {}, triangles};
  const PositionView strided(interleaved.data(), arrays.positions.size(), 5 * sizeof(float));
  for (const MeshView& view :
       {MeshView{arrays.positions, arrays.indices}, MeshView{packed, narrow}, MeshView{strided, triangles}}) {
    const Mesh mesh = copy_mesh(view);
    EXPECT_EQ(mesh.positions, expected.positions);
    EXPECT_EQ(mesh.triangles, expected.triangles);
  }
}

TEST(FrontDoor, CountsWhatItLeavesOut) {
  Arrays arrays = shells();
  const std::size_t drawn = arrays.indices.size() / 3;
  arrays.positions.push_back({kNaN, 0, 0});
  const std::array<std::uint32_t, 9> useless{
      0, 0, 1, 0, 1, 84, arrays.indices[0], arrays.indices[1], arrays.indices[2]};
  arrays.indices.insert(arrays.indices.end(), useless.begin(), useless.end());
  const OrderedMesh kept = order({arrays.positions, arrays.indices}, quick());
  EXPECT_EQ(kept.report().mesh.degenerate, 1U);
  EXPECT_EQ(kept.report().mesh.non_finite, 1U);
  EXPECT_EQ(kept.report().mesh.duplicate, 1U);
  EXPECT_EQ(kept.report().dropped, 2U);

  const OrderedMesh once =
      order({arrays.positions, arrays.indices}, quick(), {.duplicates = DuplicatePolicy::drop});
  EXPECT_EQ(once.report().dropped, 3U);
  EXPECT_EQ(once.index_count(once.fallback()), 2 * 3 * drawn);
  EXPECT_EQ(kind_of_error([&] {
              order({arrays.positions, arrays.indices}, quick(), {.strict = true});
            }),
            ErrorKind::bad_input);
}

TEST(FrontDoor, LeavesOutIndicesOutOfRangeOfAFilesMesh) {
  const Arrays arrays = shells();
  Mesh mesh = copy_mesh({arrays.positions, arrays.indices});
  mesh.triangles.push_back({0, 1, 84});
  EXPECT_EQ(order_any_mesh(mesh, quick()).report().mesh.out_of_range, 1U);
}

TEST(FrontDoor, HasNothingToDoWithoutTriangles) {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<std::uint32_t> none;
  const std::vector<std::uint32_t> flat{0, 1, 2};
  EXPECT_EQ(kind_of_error([&] { order({positions, none}); }), ErrorKind::nothing_to_do);
  EXPECT_EQ(kind_of_error([&] { order({positions, flat}); }), ErrorKind::nothing_to_do);
  EXPECT_EQ(kind_of_error([&] { reduce_overdraw({positions, none}); }), ErrorKind::nothing_to_do);
}

TEST(FrontDoor, MakesTheOrdersOfOrderMesh) {
  const Arrays arrays = shells();
  const Mesh mesh = copy_mesh({arrays.positions, arrays.indices});
  OrderOptions options;
  options.partition = parse_partition("S0,1");
  options.max_buffers = 2;
  const OrderedMesh ordered = order({arrays.positions, arrays.indices}, options);
  const OrderResult direct = order_mesh(clean(mesh, {}, "mesh").mesh, options);
  EXPECT_EQ(ordered.orders().orders, direct.orders.orders);
  EXPECT_EQ(ordered.orders().cell_orders, direct.orders.cell_orders);
  EXPECT_EQ(ordered.orders().base_sequence, direct.orders.base_sequence);
  EXPECT_EQ(ordered.report().measured_error, direct.statistics.measured_error);
}

// --------------------------------------------------------------------------------------------- index buffers

TEST(IndexBuffer, HoldsAllOrdersAndTheFallbackInBothDirections) {
  for (const Facing facing : {Facing::duplicated, Facing::single}) {
    OrderOptions options = quick();
    options.facing = facing;
    const OrderedMesh ordered = ordered_shells(options);
    const Mesh mesh{std::vector<Vec3f>(ordered.vertex_count()), {}, ordered.triangles()};
    const IndexBuffer front = ordered.index_buffer(SortDirection::front_to_back);
    const IndexBuffer back = ordered.index_buffer();
    ASSERT_EQ(front.ranges.size(), ordered.order_count() + 1U);
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < front.ranges.size(); ++i) {
      EXPECT_EQ(front.ranges[i].first, next);
      next += front.ranges[i].count;
      const std::vector<std::uint32_t> forwards = indices_of(front, front.ranges[i]);
      const std::vector<std::uint32_t> backwards = indices_of(back, back.ranges[i]);
      ASSERT_EQ(forwards.size(), backwards.size());
      for (std::size_t k = 0; k < forwards.size(); ++k)
        ASSERT_EQ(forwards[k], backwards[backwards.size() - 3 - k / 3 * 3 + k % 3]);
      EXPECT_EQ(forwards, indices_of(ordered, i));
      if (i == ordered.order_count()) break;
      EXPECT_EQ(forwards, index_buffer(mesh, ordered.orders().orders[i]));
    }
    EXPECT_EQ(front.bytes.size(), std::size_t{next} * front.bytes_per_index);
    // Both sides of every triangle are in the fallback, because back faces are culled.
    const std::size_t sides = facing == Facing::duplicated ? 2 : 1;
    EXPECT_EQ(front.range(ordered.fallback()).count, sides * 3 * ordered.triangles().size());
  }
}

TEST(IndexBuffer, HasTheWidthThatTheVerticesNeed) {
  Arrays arrays = shells();
  const std::vector<std::uint32_t> used = arrays.indices;
  for (const std::size_t vertices : {65535U, 65536U}) {
    arrays.positions.resize(vertices);
    const OrderedMesh ordered = order({arrays.positions, used}, quick());
    const IndexBuffer buffer = ordered.index_buffer();
    EXPECT_EQ(buffer.bytes_per_index, vertices == 65535 ? 2U : 4U);
    const IndexBuffer wide = ordered.index_buffer(IndexWidth::bits_32);
    EXPECT_EQ(wide.bytes_per_index, 4U);
    EXPECT_EQ(indices_of(buffer, buffer.ranges.front()), indices_of(wide, wide.ranges.front()));
    std::vector<std::uint16_t> narrow(ordered.index_count(ordered.fallback()));
    const auto copy = [&] { ordered.copy_indices(ordered.fallback(), SortDirection::back_to_front, narrow); };
    if (vertices == 65535) {
      copy();
    } else {
      EXPECT_EQ(kind_of_error(copy, "16-bit"), ErrorKind::bad_argument);
    }
  }
}

TEST(IndexBuffer, RefusesWhatItDoesNotHold) {
  const OrderedMesh ordered = ordered_shells();
  const DrawOrder beyond{ordered.order_count() + 1, false};
  EXPECT_EQ(kind_of_error([&] { (void)ordered.index_buffer().range(beyond); }), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of_error([&] { (void)ordered.index_count(beyond); }), ErrorKind::bad_argument);
  std::vector<std::uint32_t> small(3);
  EXPECT_EQ(kind_of_error([&] { ordered.copy_indices({}, SortDirection::front_to_back, small); }, "size"),
            ErrorKind::bad_argument);
}

TEST(OrderedMesh, RefusesOrdersThatDoNotFitTheMesh) {
  const OrderedMesh ordered = ordered_shells();
  const Mesh mesh{std::vector<Vec3f>(ordered.vertex_count()), {}, ordered.triangles()};
  const auto refuses = [&](const OrderSet& orders, const Mesh& other) {
    return kind_of_error([&] { OrderedMesh(orders, other, {}); }, "orders: ") == ErrorKind::bad_argument;
  };
  OrderSet orders = ordered.orders();
  orders.cell_orders.back() = ordered.order_count();
  EXPECT_TRUE(refuses(orders, mesh));
  orders = ordered.orders();
  orders.cell_orders.pop_back();
  EXPECT_TRUE(refuses(orders, mesh));
  orders = ordered.orders();
  orders.orders.front().push_back(node_of(static_cast<std::uint32_t>(mesh.triangles.size()), false));
  EXPECT_TRUE(refuses(orders, mesh));
  Mesh smaller = mesh;
  smaller.positions.pop_back();
  EXPECT_TRUE(refuses(ordered.orders(), smaller));
}

// ------------------------------------------------------------------------------------------------- selection

TEST(Select, AnswersAsTheRuntimeHeaderDoes) {
  for (const char* views : {"S1,1", "P1"}) {
    OrderOptions options = quick();
    options.partition = parse_partition(views);
    const OrderedMesh made = ordered_shells(options);
    OrderSet limited = made.orders();
    limited.valid_to = 4;
    const Mesh mesh{std::vector<Vec3f>(made.vertex_count()), {}, made.triangles()};
    for (const OrderedMesh& ordered : {made, OrderedMesh(limited, mesh, {})}) {
      Random random(7);
      std::uint32_t fallbacks = 0;
      for (int i = 0; i < 2000; ++i) {
        const Mat4 world = random_world(random);
        const Vec3d eye = transformed(world, random.direction() * random.uniform(0.2, 8));
        const Vec3d forward = random.direction();
        const DrawOrder order = ordered.select(world, eye);
        const DrawOrder along = ordered.select_orthographic(world, forward);
        const std::array<double, 3> e{eye.x, eye.y, eye.z};
        const std::array<double, 3> f{forward.x, forward.y, forward.z};
        const auto expected = [&](std::uint32_t index) {
          return index == PELLUCID_NO_ORDER ? ordered.fallback() : DrawOrder{index, false};
        };
        const PellucidOrders& selector = ordered.selector();
        ASSERT_EQ(order, expected(pellucid_select_perspective(&selector, world.m.data(), e.data())));
        ASSERT_EQ(along, expected(pellucid_select_orthographic(&selector, world.m.data(), f.data())));
        ASSERT_EQ(ordered.select(0.5, world, eye), order);
        fallbacks += order.is_fallback ? 1 : 0;
      }
      EXPECT_GT(fallbacks, 100U);
      EXPECT_LT(fallbacks, 1900U);
    }
  }
}

TEST(Select, FallsBackWhereNoOrderHolds) {
  const OrderedMesh ordered = ordered_shells();
  EXPECT_EQ(ordered.select({}, {0.3, 0, 0}), ordered.fallback());
  EXPECT_EQ(ordered.select({}, {kNaN, 0, 0}), ordered.fallback());
  EXPECT_EQ(ordered.select(Mat4{{}}, {5, 0, 0}), ordered.fallback());
  EXPECT_FALSE(ordered.select({}, {5, 0, 0}).is_fallback);
}

TEST(Select, CopiesShareTheirTables) {
  std::vector<OrderedMesh> kept;
  const PellucidOrders* selector = nullptr;
  {
    const OrderedMesh ordered = ordered_shells();
    selector = &ordered.selector();
    kept.push_back(ordered);
  }
  EXPECT_EQ(&kept.front().selector(), selector);
  EXPECT_LT(kept.front().select({}, {4, 3, 2}).index, kept.front().order_count());
}

// -------------------------------------------------------------------------------------------------- overdraw

TEST(ReduceOverdraw, MakesTheOrdersOfOrderOverdraw) {
  const Arrays arrays = shells();
  const OrderedMesh ordered = reduce_overdraw({arrays.positions, arrays.indices}, quick_overdraw());
  OverdrawSubject subject;
  subject.triangles = ordered.triangles();
  subject.frames = {arrays.positions};
  const OverdrawOrders direct = order_overdraw(subject, quick_overdraw());
  EXPECT_EQ(ordered.orders().cell_orders, direct.cell_orders);
  EXPECT_EQ(ordered.report().overdraw, direct.run.training_overdraw);
  ASSERT_EQ(ordered.order_count(), direct.orders.size());

  // Opaque meshes are drawn front to back, every triangle once, and any order is right.
  const IndexBuffer buffer = ordered.index_buffer();
  for (const IndexRange& range : buffer.ranges) {
    std::vector<std::uint32_t> drawn = indices_of(buffer, range);
    std::vector<std::uint32_t> given = arrays.indices;
    std::sort(drawn.begin(), drawn.end());
    std::sort(given.begin(), given.end());
    EXPECT_EQ(drawn, given);
  }
  EXPECT_EQ(kind_of_error([&] { (void)ordered.index_buffer(SortDirection::back_to_front); }),
            ErrorKind::bad_argument);
  for (const Vec3d& eye : {Vec3d{0.1, 0, 0}, Vec3d{kNaN, 0, 0}, Vec3d{0, 9, 0}})
    EXPECT_FALSE(ordered.select({}, eye).is_fallback);
}

TEST(ReduceOverdraw, SelectsTheNearestPose) {
  const Arrays arrays = shells();
  std::vector<Vec3f> stretched = arrays.positions;
  for (Vec3f& p : stretched) p.x *= 3;
  std::vector<Pose> poses{{0, arrays.positions}, {1.5, stretched}};
  const MeshView mesh{arrays.positions, arrays.indices};
  const OrderedMesh ordered = reduce_overdraw(mesh, quick_overdraw(), poses);
  ASSERT_EQ(ordered.keyframes().count, 2U);
  EXPECT_EQ(ordered.keyframes(1).count, 0U);
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Mat4 world = random_world(random);
    const double time = random.uniform(-1, 3);
    const Vec3d eye = random.direction() * 5;
    const std::array<double, 3> e{eye.x, eye.y, eye.z};
    EXPECT_EQ(
        ordered.select(time, world, eye).index,
        pellucid_select_animated(&ordered.selector(), &ordered.keyframes(), time, world.m.data(), e.data()));
    EXPECT_EQ(ordered.select_orthographic(time, world, eye).index,
              pellucid_select_animated_orthographic(&ordered.selector(), &ordered.keyframes(), time,
                                                    world.m.data(), e.data()));
    EXPECT_EQ(ordered.select(time, world, eye, 1), ordered.select(world, eye));
  }
  std::swap(poses[0].time, poses[1].time);
  EXPECT_EQ(kind_of_error([&] { reduce_overdraw(mesh, quick_overdraw(), poses); }, "increasing"),
            ErrorKind::bad_argument);
  poses = {{0, std::span(stretched).first(9)}};
  EXPECT_EQ(kind_of_error([&] { reduce_overdraw(mesh, quick_overdraw(), poses); }, "vertices"),
            ErrorKind::bad_argument);
}

}  // namespace
}  // namespace pellucid
