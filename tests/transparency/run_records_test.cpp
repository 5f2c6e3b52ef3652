// Tests that runs that were stopped end like runs that were not, and that a record is used only for its own
// mesh and options.
#include "transparency/run_records.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "order_helpers.h"
#include "pellucid/checkpoint.h"
#include "transparency/cluster/clustering.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;
using testing::nested_spheres;
using testing::sample_mesh;

class RecordsFolder {
 public:
  RecordsFolder() {
    std::string name = (fs::temp_directory_path() / "pellucid-records-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~RecordsFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  RecordsFolder(const RecordsFolder&) = delete;
  RecordsFolder& operator=(const RecordsFolder&) = delete;
  [[nodiscard]] std::string path() const { return path_ + "/records"; }

 private:
  std::string path_;
};

// Asks for a stop after a number of questions, and counts stages.
class StopAfter final : public Progress {
 public:
  explicit StopAfter(std::uint64_t questions) : left_(static_cast<std::int64_t>(questions)) {}
  void begin(std::string_view name, std::uint64_t /*total*/) override { stages.emplace_back(name); }
  void advance(std::uint64_t /*amount*/) override {}
  void note(std::string_view line) override { notes.emplace_back(line); }
  [[nodiscard]] bool stop_requested() const override { return --left_ < 0; }
  std::vector<std::string> stages, notes;

 private:
  mutable std::atomic<std::int64_t> left_;
};

void expect_same(const OrderResult& a, const OrderResult& b) {
  EXPECT_EQ(a.orders.orders, b.orders.orders);
  EXPECT_EQ(a.orders.cell_orders, b.orders.cell_orders);
  EXPECT_EQ(a.orders.base_sequence, b.orders.base_sequence);
  EXPECT_EQ(a.orders.valid_to, b.orders.valid_to);
  EXPECT_EQ(a.orders.sphere.radius, b.orders.sphere.radius);
  EXPECT_EQ(a.statistics.violated_weight, b.statistics.violated_weight);
  EXPECT_EQ(a.statistics.measured_error, b.statistics.measured_error);
  EXPECT_EQ(a.statistics.iterations, b.statistics.iterations);
  EXPECT_EQ(a.statistics.edges_total, b.statistics.edges_total);
  EXPECT_EQ(a.statistics.edges_per_viewpoint, b.statistics.edges_per_viewpoint);
  EXPECT_EQ(a.statistics.intersecting_pairs, b.statistics.intersecting_pairs);
  EXPECT_EQ(a.statistics.cyclic_cells, b.statistics.cyclic_cells);
  EXPECT_EQ(a.statistics.dropped_edges, b.statistics.dropped_edges);
  EXPECT_EQ(a.statistics.dropped_weight, b.statistics.dropped_weight);
  EXPECT_EQ(a.statistics.clusters_before_relaxation, b.statistics.clusters_before_relaxation);
}

struct Case {
  std::string name;
  Mesh mesh;
  OrderOptions options;
};

std::vector<Case> cases() {
  OrderOptions budget;
  budget.partition = parse_partition("S2,0");  // searched on fewer cells
  budget.distances = {3};
  budget.min_buffers = budget.max_buffers = 2;
  OrderOptions acyclic = budget;
  acyclic.method = OrderMethod::acyclic;
  acyclic.partition = parse_partition("S1,1");
  OrderOptions upsampled = budget;
  upsampled.partition = parse_partition("S0,0");
  upsampled.upsample_from = 100;
  upsampled.refine_rounds = 2;
  upsampled.facing = Facing::single;
  const Mesh knot = sample_mesh("torus-knot", 0.1, 300);
  return {{"budget", sample_mesh("goblet", 0.05, 200), budget},
          {"acyclic", knot, acyclic},
          {"upsampled", knot, upsampled}};
}

TEST(RunRecords, StoppedRunsEndAsIfTheyHadNotBeenStopped) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const OrderResult uninterrupted = order_mesh(c.mesh, c.options);
    const RecordsFolder folder;
    std::set<std::string> kinds;  // of records that a stopped run left
    std::uint32_t stops = 0;
    for (std::uint64_t questions = 1;; questions += 3 + questions / 2) {
      StopAfter progress(questions);
      CheckpointStore store(folder.path(), &progress);
      OrderOptions options = c.options;
      options.progress = &progress;
      options.checkpoints = &store;
      try {
        const OrderResult result = order_mesh(c.mesh, options);
        expect_same(result, uninterrupted);
        break;
      } catch (const Error& error) {
        ASSERT_EQ(error.kind(), ErrorKind::interrupted) << error.what();
        ++stops;
      }
      for (const auto& entry : fs::directory_iterator(folder.path())) {
        const std::string name = entry.path().filename().string();
        kinds.insert(name.substr(0, name.find_first_of("0123456789.")));
      }
    }
    EXPECT_GT(stops, 3U);
    EXPECT_GT(kinds.size(), 2U);
  }
}

TEST(RunRecords, AFinishedRunIsNotComputedAgain) {
  const Case c = cases().front();
  const RecordsFolder folder;
  CheckpointStore store(folder.path());
  OrderOptions options = c.options;
  options.checkpoints = &store;
  const OrderResult first = order_mesh(c.mesh, options);
  StopAfter progress(1000);
  options.progress = &progress;
  expect_same(order_mesh(c.mesh, options), first);
  EXPECT_TRUE(progress.stages.empty());
  // What led to the result is gone, the result itself remains until the caller has it in safety.
  std::size_t records = 0;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    records += entry.path().extension() == ".record";
  EXPECT_EQ(records, 1U);
  store.finish();
  EXPECT_FALSE(fs::exists(folder.path()));
}

TEST(RunRecords, DamagedRecordsAreMadeAnew) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const OrderResult uninterrupted = order_mesh(c.mesh, c.options);
    const RecordsFolder folder;
    OrderOptions options = c.options;
    for (std::uint64_t questions : {30U, 200U, 100000U}) {
      StopAfter progress(questions);
      CheckpointStore store(folder.path(), &progress);
      // A byte of every record, somewhere in its middle.
      std::size_t damaged = 0;
      for (const auto& entry : fs::directory_iterator(folder.path())) {
        if (entry.path().extension() != ".record") continue;
        std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(fs::file_size(entry.path()) / 2));
        file.put('?');
        ++damaged;
      }
      options.progress = &progress;
      options.checkpoints = &store;
      try {
        expect_same(order_mesh(c.mesh, options), uninterrupted);
      } catch (const Error& error) {
        ASSERT_EQ(error.kind(), ErrorKind::interrupted) << error.what();
      }
      const auto complaints =
          std::count_if(progress.notes.begin(), progress.notes.end(),
                        [](const auto& line) { return line.find("computed anew") != std::string::npos; });
      EXPECT_LE(complaints, static_cast<std::ptrdiff_t>(damaged));
      EXPECT_EQ(complaints > 0, damaged > 0);
    }
  }
}

TEST(RunRecords, EveryOptionThatMattersMakesAnotherRun) {
  const Mesh mesh = nested_spheres(1);
  const OrderOptions plain;
  const std::vector<std::function<void(OrderOptions&)>> changes{
      [](OrderOptions& o) { o.method = OrderMethod::acyclic; },
      [](OrderOptions& o) { o.partition.level = 3; },
      [](OrderOptions& o) { o.partition.sample_level = 1; },
      [](OrderOptions& o) { o.partition.kind = PartitionKind::viewpoints; },
      [](OrderOptions& o) { o.distances = {2}; },
      [](OrderOptions& o) {
        o.distances = {2, 3};
      },
      [](OrderOptions& o) { o.facing = Facing::single; },
      [](OrderOptions& o) { o.occlusion = OcclusionSource::raster; },
      [](OrderOptions& o) { o.raster_size = 64; },
      [](OrderOptions& o) { o.tolerance = 0.01; },
      [](OrderOptions& o) { o.alpha = 0.5; },
      [](OrderOptions& o) { o.max_error = 0.01; },
      [](OrderOptions& o) { o.min_psnr = 40; },
      [](OrderOptions& o) { o.max_buffers = 5; },
      [](OrderOptions& o) { o.min_buffers = 5; },
      [](OrderOptions& o) { o.priority = MergePriority::difference; },
      [](OrderOptions& o) { o.fruitless_rounds = 1; },
      [](OrderOptions& o) { o.upsample_from = 0; },
      [](OrderOptions& o) { o.upsample_from = 100; },
      [](OrderOptions& o) { o.refine_rounds = 3; },
      [](OrderOptions& o) { o.cache_size = 16; },
      [](OrderOptions& o) { o.cache_method = CacheMethod::tipsify; },
      [](OrderOptions& o) { o.cache_slack = 0; },
      [](OrderOptions& o) { o.seed = 2; }};
  std::set<std::string> runs{run_identity(mesh, plain)};
  for (const auto& change : changes) {
    OrderOptions options = plain;
    change(options);
    runs.insert(run_identity(mesh, options));
  }
  Mesh moved = mesh;
  moved.positions[7].y += 1e-6F;
  Mesh turned = mesh;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  runs.insert(run_identity(moved, plain));
  runs.insert(run_identity(turned, plain));
  EXPECT_EQ(runs.size(), changes.size() + 3);

  StopAfter progress(0);
  OrderOptions watched = plain;
  watched.progress = &progress;
  watched.memory = 1 << 20;
  EXPECT_EQ(run_identity(mesh, watched), run_identity(mesh, plain));
}

TEST(RunRecords, ValuesComeBackAndCutOnesDoNot) {
  Clustering clustering;
  clustering.cluster_of = {0, 1, 1};
  clustering.ranks = {{2, 0, 1}, {}, {1, 2, 0}};
  clustering.cost = 0.125;
  clustering.rounds = 7;
  using Map = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;
  const Map map{{{1, 2}, 3}, {{4, 5}, 6}};
  RecordWriter writer;
  writer(clustering, map);
  const std::vector<std::byte> bytes = writer.take();

  const auto read = [](std::span<const std::byte> some, Clustering& c, Map& m) {
    RecordReader reader(some);
    return !reader.read(c) && reader.read(m);  // more follows the first, nothing the second
  };
  Clustering again;
  Map map_again;
  ASSERT_TRUE(read(bytes, again, map_again));
  EXPECT_EQ(again.cluster_of, clustering.cluster_of);
  EXPECT_EQ(again.ranks, clustering.ranks);
  EXPECT_EQ(again.cost, clustering.cost);
  EXPECT_EQ(again.rounds, clustering.rounds);
  EXPECT_EQ(map_again, map);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Clustering c;
    Map m;
    EXPECT_FALSE(read(std::span(bytes).first(size), c, m)) << size;
  }
}

TEST(RunRecords, AllOfAnOrderSetComesBack) {
  OrderSet set;
  set.purpose = OrderPurpose::overdraw;
  set.sphere = {{1, 2, 3}, 4};
  set.orders = {{0, 2}, {2, 0}};
  set.patch_offsets = {0, 1, 2};
  set.model_ranks = {1, 0};
  set.animations = {{7, {0, 0.5}, {{{1, 0, 0}, 2}, {{0, 1, 0}, 3}}, {0, 1}}};
  RecordWriter writer;
  writer(set);
  OrderSet again;
  ASSERT_TRUE(RecordReader(writer.bytes()).read(again));
  EXPECT_EQ(again.purpose, set.purpose);
  EXPECT_EQ(again.sphere.center, set.sphere.center);
  EXPECT_EQ(again.orders, set.orders);
  EXPECT_EQ(again.patch_offsets, set.patch_offsets);
  EXPECT_EQ(again.model_ranks, set.model_ranks);
  ASSERT_EQ(again.animations.size(), 1U);
  EXPECT_EQ(again.animations[0].animation, 7U);
  EXPECT_EQ(again.animations[0].times, set.animations[0].times);
  ASSERT_EQ(again.animations[0].spheres.size(), 2U);
  EXPECT_EQ(again.animations[0].spheres[1].center, set.animations[0].spheres[1].center);
  EXPECT_EQ(again.animations[0].spheres[1].radius, 3);
  EXPECT_EQ(again.animations[0].cell_orders, set.animations[0].cell_orders);
}

}  // namespace
}  // namespace pellucid
