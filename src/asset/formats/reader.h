// Internal to the module `asset`: the table of model formats. read_model() finds the reader of a file in it,
// error messages list its formats, and fuzzing (fuzz/readers.cpp) has a target for each row.
//
// To add a format, write one file in this folder that defines its FormatReader (off.cpp is the shortest
// example), and add one line to PELLUCID_MODEL_FORMATS.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/asset.h"

namespace pellucid {

struct FormatReader {
  std::string_view name;                     // the usual extension without its dot
  std::vector<std::string_view> extensions;  // ".glb": lower case, with the dot
  // Returns whether a file that begins with these bytes is of this format, whatever its name is. For a short
  // file the bytes are the whole file. Null if the format cannot be recognised reliably; then the extension
  // decides.
  bool (*recognizes)(std::string_view first_bytes);
  // Reads a file. Throws Error{bad_input} with one line that names the file, the place if it helps, and the
  // reason.
  Model (*read)(const std::string& path, const ReadOptions& options);
};

// One line per format, in the order in which messages list them. NAME stands for the function NAME_reader().
// clang-format off
#define PELLUCID_MODEL_FORMATS(add) \
  add(gltf)                         \
  add(ply)                          \
  add(obj)                          \
  add(stl)                          \
  add(off)
// clang-format on

#define PELLUCID_DECLARE_READER(name) FormatReader name##_reader();
PELLUCID_MODEL_FORMATS(PELLUCID_DECLARE_READER)
#undef PELLUCID_DECLARE_READER

// Returns the rows of the table.
const std::vector<FormatReader>& format_readers();

}  // namespace pellucid
