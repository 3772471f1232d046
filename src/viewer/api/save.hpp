// What a page may have written: cubes, pictures and tables of what it looks at.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/api/selections.hpp"
#include "viewer/api/viewed_image.hpp"

namespace kiloband::viewer {

/// The path of a new file in `folder`.
/// format  "exr", "envi" or "png"
/// throws InputError  the name is not plain (plain_names.hpp), the format, a file that is there already
std::filesystem::path new_file(const std::filesystem::path& folder, const std::string& name,
                               const std::string& format);
/// The names (without folder) of all files that new_file()'s cube or picture has been written to.
std::vector<std::string> files_of(const std::filesystem::path& file);

/// The whole image with its variances.
/// throws InputError  the image is reduced; DeviceError  cannot be written
void save_cube(const std::filesystem::path& file, const ImageView& seen);
void save_picture(const std::filesystem::path& file, const std::string& png);

/// A line per band: its name if any has one, its interval, then mean and standard error of every curve.
std::string curves_csv(const std::vector<Band>& bands, const std::vector<Selection>& places,
                       const std::vector<Curve>& curves);

}  // namespace kiloband::viewer
