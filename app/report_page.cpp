#include "app/report_page.hpp"

#include "app/console/messages.hpp"
#include "validation/suite/child_process.hpp"

namespace kiloband {

void make_report_page(const std::filesystem::path& root, const std::string& script,
                      const std::filesystem::path& folder, const std::string& results) {
  using validation::run_child;
  const std::filesystem::path file = std::filesystem::absolute(root) / "validation/report" / script;
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    if (run_child({python, "-c", "import matplotlib, numpy"}, {}, {}).code != 0) continue;
    const auto end = run_child({python, file.string(), std::filesystem::absolute(folder).string()}, {}, {});
    tell("{}{}", end.out, end.err);
    if (end.code == 0) return;
    break;
  }
  tell(
      "note: no report.html (needs python3 with matplotlib): validation/report/{} makes it from "
      "{}/{}\n",
      script, folder.string(), results);
}

}  // namespace kiloband
