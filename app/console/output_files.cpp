#include "app/console/output_files.hpp"

#include <fmt/core.h>

#include <map>
#include <string>

#include "base/error.hpp"
#include "cube/cube_io.hpp"
#include "cube/cube_text.hpp"
#include "files/atomic_file.hpp"
#include "files/output_target.hpp"
#include "post/replicated_cube.hpp"

namespace kiloband {
namespace {

std::filesystem::path plain_name(const std::filesystem::path& file) {
  return std::filesystem::absolute(file).lexically_normal();
}

/// The files that are taken so far.
class Claims {
 public:
  explicit Claims(const std::vector<NamedFile>& inputs) {
    for (const NamedFile& input : inputs)
      if (const auto identity = output_identity(input.file)) inputs_.emplace(*identity, input);
  }

  void claim(const std::string& option, const std::filesystem::path& file) {
    const auto identity = output_identity(file);
    if (!identity) return;  // a pipe, a device
    if (const auto input = inputs_.find(*identity); input != inputs_.end())
      throw InputError(fmt::format("{} {}: would replace {}", option, file.string(), input->second.name));
    const auto [other, fresh] = taken_.emplace(*identity, file);
    if (fresh) return;
    if (plain_name(other->second) == plain_name(file))
      throw InputError(fmt::format("{} {}: another output has this name", option, file.string()));
    throw InputError(fmt::format("{} {}: a link makes this the same file as the output {}", option,
                                 file.string(), other->second.string()));
  }

 private:
  std::map<std::string, NamedFile> inputs_;
  std::map<std::string, std::filesystem::path> taken_;
};

/// All files of a cube: a writer of ENVI cubes also removes the parts that an earlier cube has left.
void claim_cube(Claims& claims, const std::filesystem::path& cube) {
  for (const auto& file : cube_output_files(cube)) claims.claim("-o", file);
}

}  // namespace

void add_inputs(OutputFiles& files, const std::string& option, const std::vector<std::string>& names) {
  for (const std::string& name : names) files.inputs.push_back({"the file of " + option, name});
}

void add_cube_input(OutputFiles& files, const std::string& name, const std::filesystem::path& cube) {
  const auto add = [&](const std::filesystem::path& one) {
    for (const auto& file : cube_files(one)) files.inputs.push_back({name, file});
  };
  add(cube);
  std::error_code unknown;  // a name that is too long for a replicate has none
  for (uint32_t r = 0; std::filesystem::exists(replicate_path(cube, r), unknown); ++r)
    add(replicate_path(cube, r));
}

void check_output_files(const OutputFiles& files) {
  Claims claims(files.inputs);
  for (const auto& cube : files.cubes) {
    claim_cube(claims, cube);
    for (uint32_t r = 0; r < files.kept_replicates; ++r) claim_cube(claims, replicate_path(cube, r));
  }
  std::vector<NamedFile> others = files.others;
  if (files.preview) others.push_back({"--preview", *files.preview});
  if (files.stats) others.push_back({"--stats", *files.stats});
  for (const auto& [option, file] : others) claims.claim(option, file);
  if (files.checkpoint) claims.claim("--checkpoint", *files.checkpoint);
  for (const auto& cube : files.cubes) check_cube_name(cube);
  if (files.preview && lowered_extension(*files.preview) != ".png") {
    throw InputError(fmt::format("--preview {}: must end in .png", files.preview->string()));
  }
  for (const auto& [option, file] : others) check_writable(file);
}

}  // namespace kiloband
