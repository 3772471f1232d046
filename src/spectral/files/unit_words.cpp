#include "spectral/files/unit_words.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/text.hpp"
#include "spectral/files/powers_of_ten.hpp"
#include "spectral/files/unit_names.hpp"
#include "spectral/files/value_units.hpp"

namespace kiloband {
namespace {

bool is_word(char c) {
  return is_ascii_letter(c) || is_ascii_digit(c) || c == '-' || c == '%';
}

bool is_frequency_or_energy(const std::string& word) {
  constexpr std::array kForeign = {"hz", "khz", "mhz", "ghz", "thz", "ev", "mev", "kev"};
  return std::ranges::find(kForeign, word) != kForeign.end();
}

/// Walks over a text in ASCII without units of power.
class WordReader {
 public:
  explicit WordReader(std::string text) : text_(std::move(text)) {}

  std::vector<UnitWord> all() {
    while (at_ < text_.size()) {
      const bool begins = at_ == 0 || !is_word(text_[at_ - 1]);
      if (begins && take_length()) continue;
      if (!is_word(text_[at_]))
        ++at_;
      else
        take_word();
    }
    return std::move(words_);
  }

 private:
  char at(std::size_t i) const { return i < text_.size() ? text_[i] : ' '; }

  std::size_t skip_blanks(std::size_t i) const {
    while (i < text_.size() && text_[i] == ' ') ++i;
    return i;
  }

  std::string lower(std::size_t from, std::size_t count) const {
    return lowered(std::string_view(text_).substr(from, count));
  }

  /// Behind "rad" at `from`, or the word in full; `from` where there is none.
  std::size_t behind_angle(std::size_t from) const {
    for (const std::string_view angle : {"radians", "radian", "rad"})
      if (lower(from, angle.size()) == angle && !is_ascii_letter(at(from + angle.size())))
        return from + angle.size();
    return from;
  }

  /// Behind "1/", "per", and for angles "rad/", "rad per" or "rad "; `from` where there is none of them.
  std::size_t behind_division(std::size_t from) const {
    const std::size_t angle = behind_angle(from);
    if (angle == from && at(from) != '1') return behind_per(from);
    const std::size_t slash = skip_blanks(angle == from ? from + 1 : angle);
    if (at(slash) == '/') return skip_blanks(slash + 1);
    return angle == from ? from : behind_per(slash);
  }

  std::size_t behind_per(std::size_t from) const {
    const std::size_t end = from + 3;  // of the word, or beyond the text
    const bool per =
        end < text_.size() && lower(from, 3) == "per" && (text_[end] == ' ' || text_[end] == '_');
    return per ? skip_blanks(end + 1) : from;
  }

  /// A length with what makes it an inverse one or a multiple; nothing where it is a length alone, which is a word like others.
  bool take_length() {
    const std::size_t name = behind_division(at_);
    std::size_t end = name;
    while (is_ascii_letter(at(end))) ++end;
    const std::optional<KnownUnit> unit = known_unit(std::string_view(text_).substr(name, end - name));
    if (!unit || unit->dimension != Dimension::kLength) return false;
    const std::optional<int> exponent = take_exponent(text_, end);
    const bool angular = behind_angle(at_) != at_;
    const bool divided = name != at_ && !exponent;
    const bool inverse = divided || exponent == -1;
    const auto [first, last] = with_powers_of_ten(text_, at_, end, PlainPowers::kNever);
    const bool scaled = first != at_ || last != end;
    if (!inverse && !scaled) return false;
    while (!begins_.empty() && begins_.back() >= first)
      begins_.pop_back(), words_.pop_back();  // of the power of ten
    const bool foreign = scaled || angular || unit->scale != 1e-2;
    add(foreign ? text_.substr(first, last - first) : "cm-1", at_, end);
    words_.back().is_foreign = foreign;
    at_ = end;
    return true;
  }

  void take_word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    add(lowered(std::string_view(text_).substr(begin, at_ - begin)), begin, at_);
    words_.back().is_foreign = is_frequency_or_energy(words_.back().text);
  }

  void add(std::string word, std::size_t begin, std::size_t end) {
    const char before = begin > 0 ? text_[begin - 1] : ' ', behind = at(end);
    const bool brackets = (before == '(' && behind == ')') || (before == '[' && behind == ']');
    begins_.push_back(begin);
    words_.push_back({std::move(word), false, brackets, text_[begin] >= 'A' && text_[begin] <= 'Z'});
  }

  std::string text_;
  std::size_t at_ = 0;
  std::vector<UnitWord> words_;
  std::vector<std::size_t> begins_;  // where they begin
};

}  // namespace

std::vector<UnitWord> unit_words(std::string_view text) {
  return WordReader(without_power_units(text)).all();
}

}  // namespace kiloband
