// The HTML pages of `validate` and `bench`: made by a Python script with matplotlib.
#pragma once

#include <filesystem>
#include <string>

namespace kiloband {

/// Runs ROOT/validation/report/SCRIPT on the folder of results. Without Python or matplotlib a note says how to make the page later:
/// the results stand for themselves.
/// results: the name of the file there that it reads
void make_report_page(const std::filesystem::path& root, const std::string& script,
                      const std::filesystem::path& folder, const std::string& results);

}  // namespace kiloband
