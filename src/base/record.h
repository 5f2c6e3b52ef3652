// Converts values to bytes and back, for the checkpoint records of a long run. In: numbers, vectors, maps,
// and structures of these. Out: their bytes, or a value that is rejected if the bytes do not match its type.
//
// Numbers are stored as they lie in memory. Lists are stored after their length. A structure lists its
// members in a function template beside it, which is found by argument-dependent lookup:
//   template <class Archive, RecordOf<Clustering> T>
//   void fields(Archive& archive, T& value) { archive(value.cluster_of, value.ranks); }
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace pellucid {

// Matches T and const T, so that one list of members serves both writing and reading.
template <class Candidate, class T>
concept RecordOf = std::is_same_v<std::remove_const_t<Candidate>, T>;

template <class T>
inline constexpr bool kIsNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T, std::size_t n>
inline constexpr bool kIsNumber<std::array<T, n>> = kIsNumber<T>;

class RecordWriter {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (put(values), ...);
  }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  template <class T>
  void put(const T& value) {
    if constexpr (kIsNumber<T>) {
      append(&value, sizeof(value));
    } else {
      fields(*this, value);
    }
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(std::uint64_t{list.size()});
    if constexpr (kIsNumber<T>) {
      append(list.data(), list.size() * sizeof(T));
    } else {
      for (const T& value : list) put(value);
    }
  }
  template <class A, class B>
  void put(const std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class Key, class T>
  void put(const std::map<Key, T>& map) {
    put(std::uint64_t{map.size()});
    for (const auto& entry : map) put(entry);
  }

  std::vector<std::byte> bytes_;
};

class RecordReader {
 public:
  explicit RecordReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  // Reads one value. Returns true if the bytes contain exactly this value and nothing else.
  template <class T>
  bool read(T& value) {
    take(value);
    return sound_ && rest_.empty();
  }
  template <class... Values>
  void operator()(Values&... values) {
    (take(values), ...);
  }

 private:
  void extract(void* data, std::size_t size) {
    sound_ = sound_ && size <= rest_.size();
    if (!sound_ || size == 0) return;
    std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  // Reads a length. Returns 0 if fewer bytes are left than the list has elements, which protects from huge
  // allocations.
  std::size_t take_length() {
    std::uint64_t length = 0;
    take(length);
    sound_ = sound_ && length <= rest_.size();
    return sound_ ? length : 0;
  }
  template <class T>
  void take(T& value) {
    if constexpr (kIsNumber<T>) {
      extract(&value, sizeof(value));
    } else {
      fields(*this, value);
    }
  }
  template <class T>
  void take(std::vector<T>& list) {
    list.resize(take_length());
    if constexpr (kIsNumber<T>) {
      extract(list.data(), list.size() * sizeof(T));
    } else {
      for (T& value : list) take(value);
    }
  }
  template <class A, class B>
  void take(std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class Key, class T>
  void take(std::map<Key, T>& map) {
    map.clear();
    for (std::size_t left = take_length(); left > 0; --left) {
      std::pair<Key, T> entry;
      take(entry);
      map.insert(map.end(), std::move(entry));
    }
  }

  std::span<const std::byte> rest_;
  bool sound_ = true;
};

}  // namespace pellucid
