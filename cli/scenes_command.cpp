#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/print.h"
#include "core/scene/scene_reader.h"

namespace raypool::cli {

void add_scenes_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("scenes", "List the built-in scenes");
    command->callback([] {
        for (const std::string& name : builtin_scene_names()) {
            const Scene scene = builtin_scene(name);
            print("{:<16} {} x {}: {}\n", name, scene.width, scene.height, scene.description);
        }
    });
}

}  // namespace raypool::cli
