// Runs the kiloband program in a temporary folder and reads what it wrote.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/cube_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// Where the program's standard output goes: to the test, to a device that is full, nowhere (`>&-`), into a
/// pipe that nobody reads.
enum class StandardOutput { kRead, kFull, kClosed, kBrokenPipe };

/// What is done to the running program.
struct Treatment {
  int signal = 0;  // sent once `after_text` has appeared on standard error, then `after_seconds`
  std::string after_text;
  double after_seconds = 0;
  std::optional<double> again_after_seconds;  // sent a second time
  StandardOutput out = StandardOutput::kRead;
  bool err_closed = false;                  // `2>&-`
  std::optional<uint64_t> file_size_limit;  // bytes, as `ulimit -f`: what a full disk is tried with
  std::vector<std::pair<std::string, std::string>> environment;  // added to that of the tests
  std::vector<std::string> under;  // command that starts the program, such as a checker with its options
  bool unprivileged = false;       // as user 65534 if we are root, to whom no folder is read-only
  std::optional<uint64_t> process_limit;  // as `ulimit -u`, for user 65533, who runs nothing else; needs root
};

struct Outcome {
  int code = -1;   // exit code; -1 if a signal ended the program
  int signal = 0;  // that ended it
  std::string out, err;
  double seconds = 0;
};

/// Runs with the folder as working directory; a program that takes longer than 120 s is killed.
Outcome run_program(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                    const Treatment& treatment = {});

nlohmann::json read_json(const TemporaryFolder& folder, const std::string& name);

/// `kiloband compare` with these arguments.
Outcome compare(const TemporaryFolder& folder, std::vector<std::string> arguments);
/// `part` is somewhere in `text`.
void expect_text(const std::string& text, const std::string& part);

/// The Cornell box that comes with the project.
std::string cornell_box();
/// Arguments of a render without messages: "render", scene, "--quiet", then `more`.
std::vector<std::string> quiet_render(const std::string& scene, const std::vector<std::string>& more);

/// <scene> with the body in line 2; a sensor of 8 x 8 pixels, a sky, a sphere.
std::string scene_text(const std::string& body);
inline const std::string kSensor =
    R"(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>)";
inline const std::string kLight = R"(<emitter type="constant"/>)";
inline const std::string kSphere = R"(<shape type="sphere"/>)";
/// scene_text() of a body with sensor, light and sphere in the line after it.
std::string complete_scene(const std::string& body);

}  // namespace kiloband::test
