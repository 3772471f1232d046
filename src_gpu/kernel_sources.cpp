#include "src_gpu/kernel_sources.hpp"

#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

namespace kiloband::gpu {
namespace {

/// Follows a file's conditionals, to know whether a line stands in one (the include guard apart).
class Conditionals {
 public:
  void see(const std::string& line) {
    static const std::regex kDirective(R"(^\s*#\s*(\w+).*)");
    std::smatch match;
    if (!std::regex_match(line, match, kDirective)) return;
    const std::string word = match[1];
    if (word.rfind("if", 0) == 0) {
      if (directives_ == 0 && word == "ifndef") guard_ = 1;
      ++depth_;
    } else if (word == "endif") {
      --depth_;
    }
    ++directives_;
  }
  bool inside() const { return depth_ > guard_; }

 private:
  int depth_ = 0, guard_ = 0, directives_ = 0;
};

class Assembler {
 public:
  explicit Assembler(const SourceMap& sources) : sources_(sources) {}

  /// certain: no conditional of an including file stands around it.
  void place(const std::string& path, bool certain) {
    if (certain) placed_.insert(path);
    open_.insert(path);
    std::istringstream lines(sources_.find(path)->second);
    output_ += "#line 1 \"" + path + "\"\n";
    Conditionals conditionals;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      conditionals.see(line);
      place_line(path, number, line, certain && !conditionals.inside());
    }
    open_.erase(path);
  }

  std::string take() { return std::move(output_); }

 private:
  void place_line(const std::string& path, int number, const std::string& line, bool certain) {
    static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)".*)re");
    std::smatch match;
    if (!std::regex_match(line, match, kInclude)) {
      output_ += line + "\n";
      return;
    }
    const std::string target = find(path, number, match[1]);
    // Include guards: what stands above already, or is just being placed, would give nothing.
    if (placed_.contains(target) || open_.contains(target)) {
      output_ += "\n";
      return;
    }
    place(target, certain);
    output_ += "#line " + std::to_string(number + 1) + " \"" + path + "\"\n";
  }

  std::string find(const std::string& path, int number, const std::string& include) const {
    for (const char* root : {"kernels/", "src/"}) {
      if (sources_.contains(root + include)) return root + include;
    }
    throw std::logic_error(path + ":" + std::to_string(number) + ": no source '" + include + "'");
  }

  const SourceMap& sources_;
  std::string output_;
  std::set<std::string> placed_, open_;
};

}  // namespace

std::string assemble_source(const SourceMap& sources, std::string_view main) {
  if (!sources.contains(main)) throw std::logic_error("no source '" + std::string(main) + "'");
  Assembler assembler(sources);
  assembler.place(std::string(main), true);
  return assembler.take();
}

}  // namespace kiloband::gpu
