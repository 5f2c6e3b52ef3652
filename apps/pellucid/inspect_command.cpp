// Implements `pellucid inspect`, which prints what a model file holds.
#include "pellucid/report.h"
#include "session.h"

namespace pellucid::cli {

void add_inspect_command(CLI::App& app, Chosen& chosen) {
  auto file = std::make_shared<std::string>();
  CLI::App* command =
      add_command(app, chosen, "inspect", "Print what a file holds: meshes, materials, animations, orders",
                  "  pellucid inspect goblet.glb\n"
                  "  pellucid inspect bunny.ply --json -",
                  1, [file](Session& session) {
                    const Model model = read_model(*file);
                    check_extensions(model, session);
                    session.print(inspect_text(model));
                    session.write_json(inspect_json(model));
                  });
  command->add_option("FILE", *file, "Model to read: glTF, GLB, PLY, OBJ, STL or OFF")
      ->required()
      ->type_name("");
}

}  // namespace pellucid::cli
