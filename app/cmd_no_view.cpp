// kiloband view in a build without the viewer (KILOBAND_VIEWER=OFF): says so, whatever else it is given.
#include "app/commands.hpp"
#include "base/error.hpp"

namespace kiloband {

Command add_view(CLI::App& program) {
  program.add_subcommand("view", "Not in this build: looks at a spectral image in a browser")->allow_extras();
  return []() -> int {
    throw InputError("view: this build has no viewer (it was configured with KILOBAND_VIEWER=OFF)");
  };
}

}  // namespace kiloband
