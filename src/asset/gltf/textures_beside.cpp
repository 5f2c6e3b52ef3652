// Implements textures_beside.h.
#include "asset/gltf/textures_beside.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include "asset/formats/images.h"
#include "asset/formats/text_cursor.h"
#include "asset/gltf/uris.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> mime_type(const Bytes& file) {
  const auto begins_with = [&](std::size_t at, std::string_view text) {
    return file.size() >= at + text.size() &&
           std::equal(text.begin(), text.end(), file.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
  };
  if (begins_with(0, "\x89PNG")) return "image/png";
  if (begins_with(0, "\xFF\xD8\xFF")) return "image/jpeg";
  if (begins_with(0, "RIFF") && begins_with(8, "WEBP")) return "image/webp";
  if (begins_with(0, "\xABKTX 20\xBB")) return "image/ktx2";
  return {};
}

bool is_same_folder(const fs::path& a, const fs::path& b) {
  std::error_code status;
  const bool same = fs::equivalent(a.empty() ? "." : a, b.empty() ? "." : b, status);
  return same && !status;
}

class TextureCarrier {
 public:
  TextureCarrier(DocumentEditor& editor, const std::string& output, bool embed)
      : editor_(editor),
        from_(fs::path(editor.document().path).parent_path()),
        to_(fs::path(output).parent_path()),
        embed_(embed || fs::path(output).extension() == ".glb"),
        stays_(!embed && is_same_folder(from_, to_)) {}

  std::vector<SideFile> carry(std::vector<std::string>& notes) {
    if (stays_ || !editor_.document().json.contains("images")) return {};
    const std::size_t count = editor_.document().json["images"].size();
    for (std::size_t i = 0; i < count; ++i) {
      const Json& image = editor_.document().json["images"][i];
      if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) continue;
      const auto uri = image["uri"].get<std::string>();
      if (is_data_uri(uri)) continue;
      const std::optional<std::string> relative = relative_path(from_, uri);
      std::error_code ignored;
      if (relative && fs::is_regular_file(from_ / *relative, ignored)) {
        carry_file(i, *relative);
      } else {
        notes.push_back("the texture " + in_quotes(uri, kLongestUri) + " is missing beside " +
                        editor_.document().path + " and is not carried over");
      }
    }
    return std::move(copies_);
  }

 private:
  void carry_file(std::size_t number, const std::string& relative) {
    Bytes file = read_file((from_ / relative).string(), kLargestImageFile);
    const std::optional<std::string> type = mime_type(file);
    if (embed_ && type) {
      const std::uint64_t view = editor_.append_view(editor_.append_bytes(editor_.host_buffer(), file));
      Json& image = editor_.document().json["images"][number];
      image.erase("uri");
      image["bufferView"] = view;
      image["mimeType"] = *type;
      return;
    }
    const std::string target = target_of(relative, file);
    editor_.document().json["images"][number]["uri"] = encode_relative_uri(target);
    const std::string path = (to_ / target).string();
    if (planned_.try_emplace(path, relative).second) copies_.emplace_back(path, std::move(file));
  }

  // Returns where a file goes below the folder of the output. A file of that name with another content stays,
  // and the copy gets a number.
  [[nodiscard]] std::string target_of(const std::string& relative, const Bytes& file) const {
    fs::path wanted = fs::path(relative).lexically_normal();
    if (wanted.is_absolute() || *wanted.begin() == "..") wanted = wanted.filename();
    fs::path target = wanted;
    for (int number = 2; is_taken(to_ / target, relative, file); ++number) {
      target = wanted;
      target.replace_filename(wanted.stem().string() + "-" + std::to_string(number) +
                              wanted.extension().string());
    }
    return target.generic_string();
  }

  [[nodiscard]] bool is_taken(const fs::path& path, const std::string& relative, const Bytes& file) const {
    if (const auto other = planned_.find(path.string()); other != planned_.end())
      return other->second != relative;
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return false;
    if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) != file.size()) return true;
    return read_file(path.string(), kLargestImageFile) != file;
  }

  DocumentEditor& editor_;
  fs::path from_, to_;
  bool embed_, stays_;
  std::vector<SideFile> copies_;
  std::map<std::string, std::string> planned_;  // path of a copy -> path beside the source
};

}  // namespace

std::vector<SideFile> carry_textures(DocumentEditor& editor, const std::string& output, bool embed,
                                     std::vector<std::string>& notes) {
  return TextureCarrier(editor, output, embed).carry(notes);
}

}  // namespace pellucid
