// The formats by the names of files.
#include "cube/cube_io.hpp"

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "files/file_set.hpp"

namespace kiloband {
namespace {

[[noreturn]] void refuse_name(const std::filesystem::path& file) {
  throw InputError("'" + file.string() +
                   "': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)");
}

/// X.HDR would stand beside the same data as X.hdr.
void check_envi_name(const std::filesystem::path& file) {
  if (file.extension() != ".hdr")
    throw InputError("'" + file.string() +
                     "': an ENVI header that is written must end in .hdr, in small letters");
}

}  // namespace

void CubeWriter::finish() {
  FileSet files;
  close(files);
  files.commit();
}

std::size_t CubeReader::floats_held() const {
  return info().bands.size() * (info().variance ? 2 : 1) + info().aux.size();
}

void check_holds_radiances(const std::filesystem::path& file, const CubeInfo& info) {
  if (!info.holds_variances) return;
  const std::filesystem::path stem = file.stem().stem();  // X of X.var.hdr
  throw InputError(file.string() + ": holds variances, not radiances: give the cube itself, " +
                   stem.string() + ".hdr, whose variances go with it");
}

void check_cube_name(const std::filesystem::path& file) {
  const std::string extension = lowered_extension(file);
  if (extension != ".exr" && extension != ".hdr") refuse_name(file);
  if (extension == ".hdr") check_envi_name(file);
}

std::vector<std::filesystem::path> cube_files(const std::filesystem::path& file) {
  const std::string extension = lowered_extension(file);
  if (extension == ".hdr" || extension == ".img") return envi_files(file);
  return {file};
}

std::vector<std::filesystem::path> cube_output_files(const std::filesystem::path& file) {
  if (lowered_extension(file) == ".hdr") return envi_output_files(file);
  return {file};
}

std::unique_ptr<CubeWriter> create_cube_writer_from(const std::filesystem::path& file, const CubeInfo& info,
                                                    uint32_t rows_per_strip, Quantity given) {
  check_cube_info(info, file.string());
  const std::string extension = lowered_extension(file);
  if (extension == ".exr") return create_exr_writer(file, info, rows_per_strip, given);
  if (extension == ".hdr") {
    check_envi_name(file);
    return create_envi_writer(file, info, rows_per_strip, given);
  }
  refuse_name(file);
}

std::unique_ptr<CubeWriter> create_cube_writer(const std::filesystem::path& file, const CubeInfo& info,
                                               uint32_t rows_per_strip) {
  return create_cube_writer_from(file, info, rows_per_strip, Quantity::kIntegral);
}

std::unique_ptr<CubeReader> open_cube(const std::filesystem::path& file, const DiagnosticSink& sink) {
  const std::string extension = lowered_extension(file);
  if (extension == ".exr") return open_exr_cube(file, sink);
  if (extension == ".hdr" || extension == ".img") return open_envi_cube(file, sink);
  throw InputError("'" + file.string() +
                   "': cannot tell the format of a cube: must end in .exr, .hdr or .img (ENVI)");
}

std::vector<std::string> unique_band_names(const std::vector<Band>& bands) {
  std::vector<std::string> names;
  names.reserve(bands.size());
  for (const Band& band : bands) {
    const Channel& c = band.channel;
    names.push_back(c.name.empty() ? format_short(c.centre_nm()) + "nm" : c.name);
  }
  return make_unique_names(std::move(names));
}

}  // namespace kiloband
