// Tests `pellucid overdraw`.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstring>

#include "command_line.h"
#include "pellucid/asset.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"
#include "pellucid/scene.h"

namespace pellucid::testing {
namespace {

std::string base64(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = (word << 8U) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[(word >> (18U - 6U * static_cast<unsigned>(k))) & 63U] : '=';
  }
  return text;
}

// A sample with opaque materials, as JSON for a .gltf in that folder.
nlohmann::json opaque_sample(const TemporaryFolder& folder, const std::string& name,
                             const std::string& detail) {
  const std::string path = folder.file("sample.gltf");
  EXPECT_EQ(run_pellucid({"sample", name, "-o", path, "--detail", detail}).code, 0);
  nlohmann::json model = parse_json_file(path);
  for (nlohmann::json& material : model["materials"]) material.erase("alphaMode");
  return model;
}

// Opaque shells one of which moves out of the others and back, in two clips.
std::string moving_shells(const TemporaryFolder& folder) {
  nlohmann::json model = opaque_sample(folder, "nested-shells", "0.05");
  const std::vector<float> data{0, 0.5F, 1, 0, 0, 0, 1.5F, 0, 0, 0, 0, 2};
  const auto buffer = model["buffers"].size();
  model["buffers"].push_back(
      {{"byteLength", 48}, {"uri", "data:application/octet-stream;base64," + base64(data)}});
  const auto view = model["bufferViews"].size();
  model["bufferViews"].push_back({{"buffer", buffer}, {"byteLength", 12}});
  model["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", 12}, {"byteLength", 36}});
  const auto accessor = model["accessors"].size();
  model["accessors"].push_back({{"bufferView", view},
                                {"componentType", 5126},
                                {"count", 3},
                                {"type", "SCALAR"},
                                {"min", {0}},
                                {"max", {1}}});
  model["accessors"].push_back(
      {{"bufferView", view + 1}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  for (const char* name : {"out", "again"}) {
    model["animations"].push_back(
        {{"name", name},
         {"samplers", {{{"input", accessor}, {"output", accessor + 1}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  }
  const std::string moving = folder.file("moving.gltf");
  spill(moving, model.dump());
  return moving;
}

// Options of a quick run: few viewpoints, small images.
Arguments quick(const std::string& input, const Arguments& more = {}) {
  Arguments arguments{"overdraw", input, "--views", "42", "--size", "64", "--max-images", "60"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(OverdrawCommand, OrdersAnAnimatedModelAndSaysHowWell) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  const std::string output = folder.file("out.glb");
  const Finished done =
      run_pellucid(quick(input, {"-o", output, "--buffers", "3", "--json", folder.file("o.json")}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = parse_json_file(folder.file("o.json"));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["method"], "refined");
  EXPECT_LE(json["buffer_count"].get<int>(), 3);
  EXPECT_EQ(json["key_frames"], 6);
  EXPECT_EQ(json["nodes"], 6 * 42);
  ASSERT_EQ(json["clips"].size(), 2U);
  EXPECT_EQ(json["clips"][0]["name"], "out");
  EXPECT_EQ(json["clips"][0]["key_frames"], 3);
  const double mean = json["overdraw"]["mean"].get<double>();
  EXPECT_GE(mean, 1.0);
  EXPECT_GE(json["overdraw"]["max"].get<double>(), mean);
  EXPECT_GE(json["between_key_frames"]["mean"].get<double>(), 1.0);
  for (const char* name : {"input", "original", "meshopt", "per-frame", "single", "paper"}) {
    const nlohmann::json& row = json["baselines"][name];
    EXPECT_GE(row["overdraw_mean"].get<double>(), 1.0) << name;
    EXPECT_GE(row["acmr"].get<double>(), 0.4) << name;
    EXPECT_GE(row["buffer_count"].get<int>(), 1) << name;
    // The shells hide each other, so an order that ignores overdraw wastes many fragments.
    EXPECT_LE(mean, row["overdraw_mean"].get<double>() + 1e-3) << name;
  }
  EXPECT_EQ(json["baselines"]["per-frame"]["buffer_count"], 6);
  EXPECT_EQ(json["by_key_frame"]["overdraw"]["refined"].size(), 6U);

  const nlohmann::json inspected =
      nlohmann::json::parse(run_pellucid({"inspect", output, "--json", "-"}).out);
  bool found = false;
  for (const nlohmann::json& primitive : inspected["primitives"]) {
    if (!primitive.contains("orders") || primitive["orders"].is_null()) continue;
    found = true;
    EXPECT_EQ(primitive["orders"]["purpose"], "overdraw");
    EXPECT_EQ(primitive["orders"]["animations"].size(), 2U);
    EXPECT_EQ(primitive["orders"]["animations"][0]["key_frames"], 3);
  }
  EXPECT_TRUE(found) << inspected.dump(1).substr(0, 2000);
}

// A file as a renderer draws it: every primitive by its own orders, in the order of their ranks.
class FileDrawing {
 public:
  explicit FileDrawing(const std::string& path) : model_(read_model(path)), posable_(model_) {
    subject_.triangles = posable_.triangles();
    subject_.parts.clear();
    for (const ModelPart& part : posable_.parts()) subject_.parts.push_back(part.first_triangle);
    for (std::uint32_t clip = 0; clip < posable_.clips().size(); ++clip) {
      for (const double time : posable_.clips()[clip].key_times) {
        at_.push_back({clip, time});
        subject_.frames.emplace_back();
        posable_.pose(clip, time, subject_.frames.back());
        Mesh mesh;
        mesh.triangles = subject_.triangles;
        mesh.positions = subject_.frames.back();
        spheres_.push_back(bounding_sphere(mesh));
      }
    }
    for (std::size_t order = 0; order < orders_of(0).orders.size(); ++order) add_order(order);
  }

  // Mean overdraw, selected by time and eye as a program does.
  double measure(const PosedOverdrawOptions& measurement) const {
    const PosedDrawingMethod file{
        "file", [this](std::uint32_t frame, const Viewpoint& viewpoint) {
          const Vec3d eye =
              spheres_[frame].center + viewpoint.direction * (viewpoint.distance * spheres_[frame].radius);
          return std::span<const std::uint32_t>(
              ranks_[select_order_at(orders_of(0), at_[frame].clip, at_[frame].time, eye)]);
        }};
    return measure_posed_overdraw(subject_, std::span(&file, 1), measurement).front().mean;
  }

 private:
  struct Moment {
    std::uint32_t clip;
    double time;
  };

  [[nodiscard]] const OrderSet& orders_of(std::size_t part) const {
    return *model_.primitives[posable_.parts()[part].primitive].orders;
  }
  void add_order(std::size_t order) {
    std::vector<std::pair<std::uint32_t, std::size_t>> parts;
    for (std::size_t part = 0; part < posable_.parts().size(); ++part)
      parts.emplace_back(orders_of(part).model_ranks[order], part);
    std::sort(parts.begin(), parts.end());
    std::vector<std::uint32_t> sequence;
    for (const auto& [rank, part] : parts) {
      for (const NodeId node : orders_of(part).orders[order])
        sequence.push_back(posable_.parts()[part].first_triangle + triangle_of(node));
    }
    ranks_.push_back(triangle_ranks(sequence));
  }

  Model model_;
  PosableModel posable_;
  OverdrawSubject subject_;
  std::vector<Moment> at_;
  std::vector<BoundingSphere> spheres_;
  std::vector<std::vector<std::uint32_t>> ranks_;
};

TEST(OverdrawCommand, TheWrittenFileDrawsAsMeasured) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  for (const char* encoding : {"patches", "indices", "meshopt"}) {
    const std::string output = folder.file(std::string(encoding) + ".glb");
    const Finished done = run_pellucid(quick(input, {"-o", output, "--encoding", encoding, "--sides",
                                                     "single", "--baselines", "none", "--json", "-"}));
    ASSERT_EQ(done.code, 0) << done.err;
    PosedOverdrawOptions measurement;
    measurement.size = 64;
    measurement.most_images = 60;
    const double told = nlohmann::json::parse(done.out)["overdraw"]["mean"].get<double>();
    EXPECT_NEAR(FileDrawing(output).measure(measurement), told, 1e-6) << encoding;
  }
}

TEST(OverdrawCommand, WritesTheSameBytesWithAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  for (const char* threads : {"1", "2"}) {
    ASSERT_EQ(run_pellucid(quick(input, {"-o", folder.file(std::string(threads) + ".glb"), "--baselines",
                                         "none", "--threads", threads}))
                  .code,
              0);
  }
  EXPECT_EQ(slurp(folder.file("1.glb")), slurp(folder.file("2.glb")));
}

TEST(OverdrawCommand, MakesBuffersPerAnimationWhenAsked) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  const Finished done = run_pellucid(quick(input, {"-o", folder.file("o.glb"), "--per-animation", "--buffers",
                                                   "2", "--baselines", "none", "--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_EQ(json["joint"], false);
  EXPECT_GE(json["buffer_count"].get<int>(), 2);
  EXPECT_EQ(run_pellucid({"inspect", folder.file("o.glb")}).code, 0);
}

TEST(OverdrawCommand, NeverWastesMoreFragmentsThanTheInput) {
  const TemporaryFolder folder;
  const std::string input = folder.file("tetrahedron.obj");
  spill(input, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const Finished done = run_pellucid(quick(input, {"-o", folder.file("o.glb"), "--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_EQ(json["buffer_count"], 1);
  EXPECT_LE(json["overdraw"]["mean"].get<double>(),
            json["baselines"]["input"]["overdraw_mean"].get<double>());
}

TEST(OverdrawCommand, WritesAnOpaqueMaterialForMeshesWithoutOne) {
  const TemporaryFolder folder;
  const std::string mesh = folder.file("tetrahedron.obj");
  spill(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string output = folder.file("out.glb");
  for (const char* sides : {"auto", "both"}) {
    const Finished done = run_pellucid(quick(mesh, {"-o", output, "--sides", sides, "--baselines", "none"}));
    ASSERT_EQ(done.code, 0) << done.err;
    const Model written = read_model(output);
    EXPECT_EQ(written.primitives[0].alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(written.primitives[0].double_sided, std::string(sides) == "both");
  }
}

TEST(OverdrawCommand, InterruptedLeavesNothing) {
  const TemporaryFolder input;
  const std::string knot = input.file("knot.gltf");
  spill(knot, opaque_sample(input, "torus-knot", "2").dump());
  const TemporaryFolder folder;
  const Finished done =
      interrupt_pellucid({"overdraw", knot, "-o", folder.file("out.gltf"), "--size", "1024", "--report",
                          folder.file("out.html"), "--json", folder.file("out.json")},
                         SIGINT, 0.6);
  EXPECT_EQ(done.code, 130) << done.err;
  EXPECT_EQ(done.err, "pellucid: interrupted\n");
  EXPECT_TRUE(folder.files().empty());
}

TEST(OverdrawCommand, RefusesInvalidOptions) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  const auto code = [&](const Arguments& more) {
    const Finished done = run_pellucid(quick(input, more));
    EXPECT_EQ(count_lines(done.err), 1U) << done.err;
    return done.code;
  };
  EXPECT_EQ(code({"-o", folder.file("o.obj")}), 2);
  EXPECT_EQ(code({"-o", folder.file("o.glb"), "--whole"}), 2);
  EXPECT_EQ(code({"-o", folder.file("o.glb"), "--subdivide", "1"}), 2);
  EXPECT_EQ(code({"--animation", "Dance"}), 2);
  EXPECT_EQ(code({"--baselines", "magic"}), 2);
  EXPECT_EQ(code({"--keyframe-rate", "-1"}), 2);
  EXPECT_EQ(code({"--joint", "--per-animation"}), 2);
  const Finished many = run_pellucid({"overdraw", input, "--views", "100"});
  EXPECT_EQ(many.code, 2);
  EXPECT_EQ(run_pellucid({"overdraw", folder.file("nowhere.glb")}).code, 3);
  // Everything in the sample is translucent: nothing to do.
  const std::string glass = folder.file("glass.glb");
  ASSERT_EQ(run_pellucid({"sample", "nested-shells", "-o", glass, "--detail", "0.1"}).code, 0);
  EXPECT_EQ(run_pellucid({"overdraw", glass}).code, 4);
  for (const std::string& file : folder.files()) EXPECT_EQ(file.find("o."), std::string::npos) << file;
}

TEST(OverdrawCommand, WritesReportChartAndHeatMaps) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  ASSERT_EQ(run_pellucid(quick(input, {"--baselines", "original", "--report", folder.file("r.html"),
                                       "--heatmaps", folder.file("h.png"), "--chart", folder.file("c.svg")}))
                .code,
            0);
  EXPECT_EQ(slurp(folder.file("h.png")).substr(1, 3), "PNG");
  EXPECT_NE(slurp(folder.file("c.svg")).find("<svg"), std::string::npos);
  const std::string page = slurp(folder.file("r.html"));
  EXPECT_NE(page.find("original"), std::string::npos);
  EXPECT_EQ(page.find("http://"), page.find("http://www.w3.org"));
}

#ifdef PELLUCID_WITH_OPENSUBDIV
TEST(OverdrawCommand, SubdividesForMeasurements) {
  const TemporaryFolder folder;
  const std::string input = moving_shells(folder);
  const Finished done = run_pellucid(quick(
      input, {"--subdivide", "1", "--whole", "--baselines", "none", "--animation", "out", "--json", "-"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  const nlohmann::json whole =
      nlohmann::json::parse(run_pellucid(quick(input, {"--baselines", "none", "--json", "-"})).out);
  EXPECT_EQ(json["triangles"].get<int>(), 4 * whole["triangles"].get<int>());
  EXPECT_EQ(json["key_frames"], 3);
}
#else
TEST(OverdrawCommand, RefusesToSubdivideInABuildWithoutOpenSubdiv) {
  const TemporaryFolder folder;
  const Finished done = run_pellucid(quick(moving_shells(folder), {"--subdivide", "1"}));
  EXPECT_EQ(done.code, 2);
  EXPECT_NE(done.err.find("PELLUCID_OPENSUBDIV"), std::string::npos) << done.err;
}
#endif

#if defined(PELLUCID_WITH_RENDERER)
// The triangle that is drawn first remains visible. Triangles are drawn in the orders of the file, at rest
// and in motion.
TEST(OverdrawCommand, RendersInTheDrawOrderOfTheFile) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out.glb");
  ASSERT_EQ(run_pellucid({"overdraw", moving_shells(folder), "-o", out, "--baselines", "none",
                          "--check-views", "4", "--size", "64", "--views", "12"})
                .code,
            0);
  const auto drawn = [&](const std::string& technique, const Arguments& more) {
    Arguments arguments{"render", out,      "-o",   folder.file("p.png"), "--technique", technique, "--k",
                        "1",      "--size", "96x64"};
    if (technique == "fab") arguments.push_back("--plain-resolve");
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return slurp(folder.file("p.png"));
  };
  for (const Arguments& moment : {Arguments{}, Arguments{"--animation", "out", "--time", "0.5"}}) {
    Arguments as_stored = moment;
    as_stored.push_back("--ignore-orders");
    EXPECT_NE(drawn("fab", moment), drawn("fab", as_stored));
    EXPECT_EQ(drawn("kb", moment), drawn("kb", as_stored));
  }
}
#endif

}  // namespace
}  // namespace pellucid::testing
