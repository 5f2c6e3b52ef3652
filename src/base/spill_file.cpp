// Implements SpillFile on platform::File.
#include "base/spill_file.h"

#include <system_error>

#include "base/platform/platform.h"
#include "pellucid/base.h"

namespace pellucid {
namespace {

// Calls `work`. If the system reports an error, throws an Error that names the folder and what failed.
template <class Work>
auto named(const std::string& folder, const char* what, const Work& work) {
  try {
    return work();
  } catch (const std::system_error& error) {
    throw Error(ErrorKind::cannot_write,
                folder + ": cannot " + what + " a temporary file: " + error.code().message());
  }
}

}  // namespace

SpillFile::SpillFile() : folder_(platform::temporary_folder()) {
  file_ = named(folder_, "make",
                [&] { return std::make_unique<platform::File>(platform::File::create_temporary(folder_)); });
}

SpillFile::~SpillFile() = default;

std::uint64_t SpillFile::append(std::span<const std::uint32_t> words) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t begin = end_;
  named(folder_, "write to", [&] { file_->write_at(begin * sizeof(std::uint32_t), std::as_bytes(words)); });
  end_ += words.size();
  return begin;
}

void SpillFile::read(std::uint64_t position, std::span<std::uint32_t> words) const {
  named(folder_, "read from",
        [&] { file_->read_at(position * sizeof(std::uint32_t), std::as_writable_bytes(words)); });
}

}  // namespace pellucid
