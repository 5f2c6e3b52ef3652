// JSON text to a document: see gltf_json.h.
#include "asset/gltf_json.h"

namespace pellucid {
namespace {

constexpr std::size_t kMaxText = std::size_t{512} << 20U;
constexpr std::size_t kMaxDepth = 128;
constexpr std::size_t kMaxKeys = 10000;
constexpr std::size_t kMaxComplaint = 200;  // characters of the parser's own message

// "[json.exception.parse_error.101] parse error at line 1 ..." without the bracket, cut to a line.
std::string parser_complaint(const std::string& what) {
  const std::size_t bracket = what.find("] ");
  std::string text = bracket == std::string::npos ? what : what.substr(bracket + 2);
  if (text.size() > kMaxComplaint) text = text.substr(0, kMaxComplaint) + "...";
  return text;
}

// Walks the text once without building anything and says why it must not be built.
class Guard : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool key(string_t&) override {
    if (++keys_.back() <= kMaxKeys) return true;
    complaint = "an object has more than " + std::to_string(kMaxKeys) + " keys";
    return false;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) override {
    complaint = parser_complaint(error.what());
    return false;
  }

  std::string complaint;

 private:
  bool open() {
    keys_.push_back(0);
    if (keys_.size() <= kMaxDepth) return true;
    complaint = "it nests deeper than " + std::to_string(kMaxDepth) + " levels";
    return false;
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  std::vector<std::size_t> keys_;  // per open object or array
};

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  const auto fail = [&](const std::string& reason) -> Error {
    return {ErrorKind::bad_input, file + ": bad JSON: " + reason};
  };
  if (text.size() > kMaxText) throw fail("longer than 512 MiB");
  Guard guard;
  if (!Json::sax_parse(text, &guard)) throw fail(guard.complaint);
  Json json = Json::parse(text);
  if (!json.is_object()) throw fail("it is not an object");
  return json;
}

}  // namespace pellucid
