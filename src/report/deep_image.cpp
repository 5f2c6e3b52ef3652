// Collects the fragments of every pixel as a deep image, and writes it as a deep OpenEXR file. In: a drawn
// result with fragments. Out: a deep image, a file.
#include "pellucid/deep_image.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#ifdef PELLUCID_WITH_OPENEXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfPartType.h>
#endif

namespace pellucid {
namespace {

float distance_of(float depth, const Camera& camera) {
  const double n = camera.near_plane;
  const double f = camera.far_plane;
  const double d = static_cast<double>(depth);
  return static_cast<float>(camera.perspective ? n * f / (f - d * (f - n)) : n + d * (f - n));
}

}  // namespace

std::span<const DeepFragment> DeepImage::at(std::uint32_t x, std::uint32_t y) const {
  const std::size_t p = std::size_t{y} * width + x;
  return std::span(fragments).subspan(offsets[p], offsets[p + 1] - offsets[p]);
}

DeepImage make_deep_image(const RenderResult& result, const RenderScene& scene, const Camera& camera) {
  const CapturedFragments& captured = result.fragments;
  const std::size_t pixels = std::size_t{result.width} * result.height;
  if (captured.offsets.size() != pixels + 1 || captured.colors.size() != captured.fragments.size())
    throw Error(ErrorKind::bad_argument,
                "a deep image needs fragments with colours, and one sample per pixel");
  DeepImage image{result.width, result.height, captured.offsets, {}};
  std::vector<std::size_t> places;
  for (std::size_t p = 0; p < pixels; ++p) {
    places.resize(captured.offsets[p + 1] - captured.offsets[p]);
    std::iota(places.begin(), places.end(), captured.offsets[p]);
    // Techniques that peel from both ends deliver the far half in reverse order.
    std::sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
      const Fragment& x = captured.fragments[a];
      const Fragment& y = captured.fragments[b];
      return x.depth < y.depth || (x.depth == y.depth && x.node < y.node);
    });
    for (const std::size_t i : places) {
      const Fragment& f = captured.fragments[i];
      image.fragments.push_back({f.depth, distance_of(f.depth, camera), f.node,
                                 scene.objects[triangle_of(f.node)], captured.colors[i]});
    }
  }
  return image;
}

#ifdef PELLUCID_WITH_OPENEXR

namespace {

// A file in memory, so that it can be written completely or not at all.
class MemoryStream final : public Imf::OStream {
 public:
  MemoryStream() : OStream("deep image") {}
  void write(const char* bytes, int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (place_ + n > data_.size()) data_.resize(place_ + n);
    std::memcpy(data_.data() + place_, bytes, n);
    place_ += n;
  }
  std::uint64_t tellp() override { return place_; }
  void seekp(std::uint64_t place) override { place_ = static_cast<std::size_t>(place); }
  [[nodiscard]] const std::string& data() const { return data_; }

 private:
  std::string data_;
  std::size_t place_ = 0;
};

// A channel with one value per fragment.
template <class Value>
struct Channel {
  const char* name;
  Imf::PixelType type;
  std::vector<Value> values;
  std::vector<char*> rows{};  // address of the first value of every pixel

  void add_to(Imf::Header& header, Imf::DeepFrameBuffer& buffer, const DeepImage& image) {
    header.channels().insert(name, Imf::Channel(type));
    rows.reserve(image.offsets.size());
    for (std::size_t p = 0; p + 1 < image.offsets.size(); ++p) {
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): OpenEXR takes all types as char
      rows.push_back(reinterpret_cast<char*>(values.data() + image.offsets[p]));
    }
    buffer.insert(name, Imf::DeepSlice(type,
                                       // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
                                       reinterpret_cast<char*>(rows.data()), sizeof(char*),
                                       sizeof(char*) * image.width, sizeof(Value)));
  }
};

template <class Value, class Of>
std::vector<Value> each(const DeepImage& image, const Of& of) {
  std::vector<Value> values;
  values.reserve(image.fragments.size());
  for (const DeepFragment& f : image.fragments) values.push_back(of(f));
  return values;
}

}  // namespace

bool can_write_deep_exr() {
  return true;
}

void write_deep_exr(const DeepImage& image, const std::string& path) {
  Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;

  std::vector<std::uint32_t> counts;
  for (std::size_t p = 0; p + 1 < image.offsets.size(); ++p)
    counts.push_back(static_cast<std::uint32_t>(image.offsets[p + 1] - image.offsets[p]));
  Imf::DeepFrameBuffer buffer;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                           sizeof(std::uint32_t), sizeof(std::uint32_t) * image.width));
  const auto color = [&](std::size_t c) {
    return each<float>(image, [c](const DeepFragment& f) { return f.color.at(c) * f.color[3]; });
  };
  std::array<Channel<float>, 5> reals{
      {{"R", Imf::FLOAT, color(0)},
       {"G", Imf::FLOAT, color(1)},
       {"B", Imf::FLOAT, color(2)},
       {"A", Imf::FLOAT, each<float>(image, [](const DeepFragment& f) { return f.color[3]; })},
       {"Z", Imf::FLOAT, each<float>(image, [](const DeepFragment& f) { return f.distance; })}}};
  std::array<Channel<std::uint32_t>, 2> integers{
      {{"object", Imf::UINT, each<std::uint32_t>(image, [](const DeepFragment& f) { return f.object; })},
       {"node", Imf::UINT, each<std::uint32_t>(image, [](const DeepFragment& f) { return f.node; })}}};
  for (auto& channel : reals) channel.add_to(header, buffer, image);
  for (auto& channel : integers) channel.add_to(header, buffer, image);

  MemoryStream stream;
  try {
    Imf::DeepScanLineOutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(static_cast<int>(image.height));
  } catch (const std::exception& error) {
    throw Error(ErrorKind::cannot_write, path + ": OpenEXR: " + error.what());
  }
  write_file_atomically(path, std::string_view(stream.data()));
}

#else

bool can_write_deep_exr() {
  return false;
}

void write_deep_exr(const DeepImage& /*image*/, const std::string& path) {
  throw Error(ErrorKind::bad_argument,
              path + ": this build of pellucid cannot write OpenEXR (PELLUCID_OPENEXR is off)");
}

#endif

}  // namespace pellucid
