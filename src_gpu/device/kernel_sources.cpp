#include "src_gpu/device/kernel_sources.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace kiloband::opencl {
namespace {

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t")));
  return text;
}

/// A line of the preprocessor: "#  include "a.h" // b" has the word "include" and the rest behind it.
struct Directive {
  std::string_view word, rest;  // empty: the line is none
};

Directive directive_of(std::string_view line) {
  line = without_blanks(line);
  if (line.empty() || line.front() != '#') return {};
  line = without_blanks(line.substr(1));
  const auto end = std::find_if(line.begin(), line.end(), [](unsigned char c) { return !std::isalpha(c); });
  const auto length = static_cast<std::size_t>(end - line.begin());
  return {line.substr(0, length), without_blanks(line.substr(length))};
}

/// The name between quotes of an #include line; empty for any other.
std::string include_of(const Directive& directive) {
  if (directive.word != "include" || directive.rest.empty() || directive.rest.front() != '"') return {};
  return std::string(directive.rest.substr(1, directive.rest.find('"', 1) - 1));
}

/// Follows a file's conditionals, to know whether a line stands in one (the include guard apart).
class Conditionals {
 public:
  void see(std::string_view word) {
    if (word.empty()) return;
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

bool is_of_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

/// Is what ends here "#define "?
bool ends_in_define(std::string_view line) {
  const Directive directive = directive_of(line);
  return directive.word == "define" && directive.rest.empty();
}

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
      const Directive directive = directive_of(line);
      conditionals.see(directive.word);
      place_line(path, number, line, include_of(directive), certain && !conditionals.inside());
    }
    open_.erase(path);
  }

  std::string take() { return std::move(output_); }

 private:
  void place_line(const std::string& path, int number, const std::string& line, const std::string& include,
                  bool certain) {
    if (include.empty()) {
      output_ += line + "\n";
      return;
    }
    const std::string target = find(path, number, include);
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

bool asks_for(std::string_view source, std::string_view macro) {
  for (std::size_t at = source.find(macro); at != source.npos; at = source.find(macro, at + macro.size())) {
    const std::size_t end = at + macro.size();
    const bool whole =
        (at == 0 || !is_of_name(source[at - 1])) && (end == source.size() || !is_of_name(source[end]));
    if (!whole) continue;
    const std::size_t line = source.rfind('\n', at);  // of the first line: npos + 1 is 0
    if (!ends_in_define(source.substr(line + 1, at - line - 1))) return true;
  }
  return false;
}

}  // namespace kiloband::opencl
