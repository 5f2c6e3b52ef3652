// Implements CheckpointStore: the file format of records, the lock of the folder, and the notes to the user.
#include "pellucid/checkpoint.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>

#include "base/platform/platform.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".record";
constexpr std::string_view kLockName = ".lock";
// write_file_atomically() appends a dot and this many characters to the name of a file while it writes it.
constexpr std::size_t kTemporaryCharacters = 6;

// Follows the bytes of a record in its file.
struct Trailer {
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;                 // seeded by the file name, so that a renamed file is rejected
  std::uint64_t magic = 0x31305245434C4C50U;  // identifies the format and the byte order
};
static_assert(sizeof(Trailer) == 3 * sizeof(std::uint64_t));

[[noreturn]] void fail(const std::string& folder, const std::string& reason) {
  throw Error(ErrorKind::cannot_write, folder + ": cannot keep checkpoints: " + reason);
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(platform::to_path(folder), error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(platform::to_utf8(entry->path().filename()));
  }
  if (error) fail(folder, error.message());
  std::sort(names.begin(), names.end());
  return names;
}

void remove_file(const std::string& path) {
  std::error_code ignored;
  fs::remove(platform::to_path(path), ignored);
}

bool is_half_written(const std::string& name) {
  const std::size_t at = name.rfind(kExtension);
  return at != std::string::npos && name.size() == at + kExtension.size() + 1 + kTemporaryCharacters &&
         name[at + kExtension.size()] == '.';
}

std::uint64_t mixed(std::uint64_t x) {
  x *= 0x9E3779B97F4A7C15U;
  return x ^ (x >> 32U);
}

std::uint64_t checksum_of(std::span<const std::byte> bytes, const std::string& path) {
  const std::string name = platform::to_utf8(platform::to_path(path).filename());
  return hash_bytes(bytes, hash_bytes(std::as_bytes(std::span(name)), 0));
}

}  // namespace

std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed) {
  // Run four independent chains, because a multiplication takes several cycles. Every step is a bijection of
  // both the chain and the word, so a change of a single word always changes the hash.
  std::array<std::uint64_t, 4> chains{seed, seed + 1, seed + 2, seed + 3};
  constexpr std::size_t kBlock = sizeof(chains);
  std::array<std::uint64_t, 4> words{};
  const std::size_t size = bytes.size();
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), kBlock))) {
    if (bytes.size() < kBlock) words = {};
    std::memcpy(words.data(), bytes.data(), std::min(bytes.size(), kBlock));
    for (std::size_t i = 0; i < chains.size(); ++i) chains[i] = mixed(chains[i] ^ words[i]);
  }
  std::uint64_t hash = mixed(mixed(seed) ^ size);
  for (const std::uint64_t chain : chains) hash = mixed(hash ^ mixed(chain));
  return mixed(hash);
}

CheckpointStore::CheckpointStore(std::string folder, Progress* progress)
    : folder_(std::move(folder)), progress_(progress) {
  std::error_code error;
  fs::create_directory(platform::to_path(folder_), error);
  if (error && error != std::errc::file_exists) fail(folder_, error.message());
  try {
    lock_ = std::make_unique<platform::FileLock>(folder_ + "/" + std::string(kLockName));
  } catch (const std::system_error& refused) {
    const bool is_held = refused.code() == std::errc::resource_unavailable_try_again;
    fail(folder_, is_held ? "another run is using this folder" : refused.code().message());
  }
  for (const std::string& name : names_in(folder_)) {
    if (is_half_written(name)) remove_file(folder_ + "/" + name);
  }
}

CheckpointStore::~CheckpointStore() {
  leave();
}

void CheckpointStore::leave() {
  if (lock_ == nullptr) return;
  lock_.reset();
  platform::remove_empty_folder(folder_);
}

void CheckpointStore::begin_run(const std::string& run) {
  if (!runs_.insert(run).second || progress_ == nullptr) return;
  std::size_t own = 0;
  std::size_t foreign = 0;
  for (const std::string& name : names_in(folder_)) {
    if (!name.ends_with(kExtension)) continue;
    const auto is_of = [&](const std::string& r) {
      return name.ends_with("." + r + std::string(kExtension));
    };
    if (is_of(run)) {
      ++own;
    } else if (std::none_of(runs_.begin(), runs_.end(), is_of)) {
      ++foreign;
    }
  }
  if (own > 0) {
    progress_->note(folder_ + ": continuing from " + std::to_string(own) + " record(s)");
  } else if (foreign > 0) {
    // A continued run visits its meshes in the same order, so records of none of the runs so far belong to
    // others.
    progress_->note(folder_ + ": " + std::to_string(foreign) +
                    " record(s) of another mesh, other options or another version of pellucid: ignored");
  }
}

std::optional<std::vector<std::byte>> CheckpointStore::load(const std::string& run, const std::string& name) {
  const std::string path = path_of(run, name);
  if (platform::file_kind(path) == platform::FileKind::missing) return std::nullopt;
  const auto damaged = [&](const std::string& reason) {
    if (progress_ != nullptr) progress_->note(path + ": " + reason + ": computed anew");
    return std::nullopt;
  };
  std::vector<std::byte> bytes;
  try {
    bytes = read_file(path, UINT64_MAX);
  } catch (const Error& error) {
    return damaged(error.what());
  }
  Trailer trailer;
  if (bytes.size() < sizeof(trailer)) return damaged("a truncated record");
  std::memcpy(&trailer, bytes.data() + bytes.size() - sizeof(trailer), sizeof(trailer));
  bytes.resize(bytes.size() - sizeof(trailer));
  if (trailer.magic != Trailer{}.magic || trailer.size != bytes.size()) return damaged("a truncated record");
  if (trailer.checksum != checksum_of(bytes, path)) return damaged("a damaged record");
  return bytes;
}

void CheckpointStore::save(const std::string& run, const std::string& name, std::vector<std::byte> bytes) {
  const std::string path = path_of(run, name);
  Trailer trailer;
  trailer.size = bytes.size();
  trailer.checksum = checksum_of(bytes, path);
  bytes.resize(bytes.size() + sizeof(trailer));
  std::memcpy(bytes.data() + bytes.size() - sizeof(trailer), &trailer, sizeof(trailer));
  write_file_atomically(path, bytes);
}

void CheckpointStore::refuse(const std::string& run, const std::string& name) {
  if (progress_ != nullptr) progress_->note(path_of(run, name) + ": a record of another form: computed anew");
}

void CheckpointStore::remove_others(const std::string& run, const std::string& kept) {
  for (const std::string& path : records_of(run)) {
    if (path != path_of(run, kept)) remove_file(path);
  }
}

void CheckpointStore::finish() {
  for (const std::string& run : runs_) {
    for (const std::string& path : records_of(run)) remove_file(path);
  }
  runs_.clear();
  leave();
}

std::string CheckpointStore::path_of(const std::string& run, const std::string& name) const {
  return folder_ + "/" + name + "." + run + std::string(kExtension);
}

std::vector<std::string> CheckpointStore::records_of(const std::string& run) const {
  std::vector<std::string> paths;
  for (const std::string& name : names_in(folder_)) {
    if (name.ends_with("." + run + std::string(kExtension))) paths.push_back(folder_ + "/" + name);
  }
  return paths;
}

}  // namespace pellucid
