// Writes small model files for tests. In: text or bytes. Out: what read_model() returns, or its error
// message.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "pellucid/asset.h"

namespace pellucid {

// A file in the test's temporary folder that goes when the object goes.
class TemporaryModel {
 public:
  TemporaryModel(const std::string& name, std::string_view content)
      : path_(testing::TempDir() + "pellucid-" + std::to_string(::getpid()) + "-" + name) {
    write(content);
  }
  ~TemporaryModel() { std::remove(path_.c_str()); }
  TemporaryModel(const TemporaryModel&) = delete;
  TemporaryModel& operator=(const TemporaryModel&) = delete;

  void write(std::string_view content) const {
    // A new file each time: some file systems flush one that is truncated and written again to the disk.
    std::remove(path_.c_str());
    std::FILE* file = std::fopen(path_.c_str(), "wb");
    ASSERT_NE(file, nullptr) << path_;
    ASSERT_EQ(std::fwrite(content.data(), 1, content.size(), file), content.size());
    ASSERT_EQ(std::fclose(file), 0);
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// `name` is that of a file that does not exist; only its extension matters.
inline Model read_text(const std::string& name, std::string_view content, const ReadOptions& options = {}) {
  const TemporaryModel file(name, content);
  return read_model(file.path(), options);
}

inline Mesh mesh_of(const std::string& name, std::string_view content) {
  Model model = read_text(name, content);
  EXPECT_EQ(model.primitives.size(), 1U);
  EXPECT_EQ(model.instances.size(), 1U);
  return model.primitives.at(0).mesh;
}

// The message with which reading fails, without the folder; fails the test where it succeeds.
inline std::string complaint(const std::string& name, std::string_view content,
                             const ReadOptions& options = {}) {
  const TemporaryModel file(name, content);
  try {
    read_model(file.path(), options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_input);
    const std::string message = error.what();
    EXPECT_EQ(message.substr(0, file.path().size()), file.path());
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message.substr(file.path().size());
  }
  ADD_FAILURE() << "read without complaint";
  return "";
}

// Bytes of numbers, least significant first or last.
class ByteWriter {
 public:
  explicit ByteWriter(bool big_endian) : big_endian_(big_endian) {}

  template <class Value>
  ByteWriter& put(Value value) {
    std::array<char, sizeof(Value)> bytes = std::bit_cast<std::array<char, sizeof(Value)>>(value);
    if (big_endian_ == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
    bytes_.append(bytes.data(), bytes.size());
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

// A binary STL file of one triangle, repeated.
inline std::string binary_stl(std::string header, std::uint32_t declared, std::uint32_t present) {
  header.resize(80, ' ');
  ByteWriter out(false);
  out.put(declared);
  for (std::uint32_t i = 0; i < present; ++i) {
    for (const float value : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, static_cast<float>(i)}) {
      out.put(value);
    }
    out.put(std::uint16_t{0});
  }
  return header + out.bytes();
}

}  // namespace pellucid
