#include "app/output_files.hpp"

#include <fmt/core.h>

#include <set>
#include <string>

#include "base/error.hpp"
#include "film/atomic_file.hpp"
#include "film/cube_io.hpp"
#include "film/cube_text.hpp"
#include "film/replicated_cube.hpp"

namespace kiloband {
namespace {

std::filesystem::path identity(const std::filesystem::path& file) {
  std::error_code error;
  const auto real = std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error);
  return error ? file : real;
}

std::string extension_of(const std::filesystem::path& file) {
  return to_lower(file.extension().string());
}

/// The names that are taken so far.
class Claims {
 public:
  explicit Claims(const std::optional<std::filesystem::path>& scene) {
    if (scene) scene_ = identity(*scene);
  }

  void claim(const char* option, const std::filesystem::path& file) {
    const auto name = identity(file);
    if (scene_ && name == *scene_)
      throw InputError(fmt::format("{} {}: would replace the scene", option, file.string()));
    if (!taken_.insert(name).second) {
      throw InputError(fmt::format("{} {}: another output has this name", option, file.string()));
    }
  }

 private:
  std::optional<std::filesystem::path> scene_;
  std::set<std::filesystem::path> taken_;
};

/// All files of a cube: a writer of ENVI cubes also removes the parts that an earlier cube has left.
void claim_cube(Claims& claims, const std::filesystem::path& cube) {
  claims.claim("-o", cube);
  if (extension_of(cube) != ".hdr") return;
  for (const char* end : {".img", ".var.hdr", ".var.img", ".aux.hdr", ".aux.img"})
    claims.claim("-o", std::filesystem::path(cube).replace_extension(end));
}

}  // namespace

void check_output_files(const OutputFiles& files) {
  Claims claims(files.scene);
  for (const auto& cube : files.cubes) {
    claim_cube(claims, cube);
    for (uint32_t r = 0; r < files.kept_replicates; ++r) claim_cube(claims, replicate_path(cube, r));
  }
  if (files.preview) claims.claim("--preview", *files.preview);
  if (files.stats) claims.claim("--stats", *files.stats);
  if (files.checkpoint) claims.claim("--checkpoint", *files.checkpoint);
  for (const auto& cube : files.cubes) check_cube_name(cube);
  if (files.preview && extension_of(*files.preview) != ".png") {
    throw InputError(fmt::format("--preview {}: must end in .png", files.preview->string()));
  }
  for (const auto& file : {files.preview, files.stats}) {
    if (file) const AtomicFile trial(*file);  // its temporary file vanishes at once
  }
}

}  // namespace kiloband
