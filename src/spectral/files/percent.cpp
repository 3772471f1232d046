#include "spectral/files/percent.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/text.hpp"

namespace kiloband {
namespace {

enum class Token { kWord, kPercent, kNumber, kOpen, kClose, kEnd };

struct PercentToken {
  Token kind;
  std::string text;  // of a word, in lower case
};

bool is_small_letter(char c) {
  return (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80;
}

bool is_digit_or_point(char c) {
  return (c >= '0' && c <= '9') || c == '.';
}

template <std::size_t N>
bool is_in(const std::string& word, const std::array<const char*, N>& set) {
  return std::ranges::any_of(set, [&](const char* element) { return word == element; });
}

Token kind_of_word(const std::string& word) {
  constexpr std::array kPercents = {"percent", "pct", "percentage", "percents"};
  return is_in(word, kPercents) ? Token::kPercent : Token::kWord;
}

bool ends_with_number(const std::vector<PercentToken>& tokens) {
  return !tokens.empty() && tokens.back().kind == Token::kNumber;
}

/// Words, numbers and brackets; other signs separate. A word with digits ("b4") is a word. "column 2:" is
/// before all that follows it.
std::vector<PercentToken> percent_tokens(std::string_view name) {
  const std::string text = lowered(name);
  std::vector<PercentToken> tokens;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    std::size_t end = at + 1;
    if (is_small_letter(c)) {
      while (end < text.size() && (is_small_letter(text[end]) || is_digit_or_point(text[end]))) ++end;
      const std::string word = text.substr(at, end - at);
      tokens.push_back({kind_of_word(word), word});
    } else if (c >= '0' && c <= '9') {
      while (end < text.size() && is_digit_or_point(text[end])) ++end;
      tokens.push_back({Token::kNumber, {}});
    } else if (c == '%') {
      tokens.push_back({Token::kPercent, {}});
    } else if (c == '(' || c == '[' || c == '{') {
      tokens.push_back({Token::kOpen, {}});
    } else if (c == ')' || c == ']' || c == '}') {
      tokens.push_back({Token::kClose, {}});
    } else if (c == ';' || c == '"' || (c == ':' && ends_with_number(tokens))) {
      tokens.push_back({Token::kEnd, {}});
    }
    at = end;
  }
  return tokens;
}

bool is_quantity(const PercentToken& token) {
  constexpr std::array kQuantities = {"reflectance",
                                      "reflectances",
                                      "reflectivity",
                                      "reflection",
                                      "transmittance",
                                      "transmission",
                                      "emissivity",
                                      "transmissivity",
                                      "emittance",
                                      "absorptance",
                                      "absorptivity",
                                      "efficiency",
                                      "response",
                                      "factor",
                                      "value",
                                      "values",
                                      "unit",
                                      "units",
                                      "albedo",
                                      "y",
                                      "r",
                                      "t",
                                      "qe",
                                      "refl"};
  return token.kind == Token::kWord && is_in(token.text, kQuantities);
}

/// Words between a quantity and its unit: "reflectance is given in percent".
bool is_link(const PercentToken& token) {
  constexpr std::array kLinks = {"in", "is", "are", "as", "of", "given", "measured", "expressed"};
  return token.kind == Token::kWord && is_in(token.text, kLinks);
}

/// The percent sign at `at`, what stands around it, and what of it is a unit.
class PercentSign {
 public:
  PercentSign(const std::vector<PercentToken>& tokens, std::size_t at) : tokens_(tokens), at_(at) {
    begin_ = at_;
    while (begin_ > 0 && is_link(tokens_[begin_ - 1])) --begin_;
    wrapped_ = kind_before() == Token::kOpen && kind_behind() == Token::kClose;
    if (wrapped_) --begin_;
  }

  bool is_unit(bool of_comment) const {
    const bool quantity_before = begin_ > 0 && is_quantity(tokens_[begin_ - 1]);
    const bool is_first = kind_before() == Token::kEnd || kind_before() == Token::kOpen;
    const bool is_last = kind_behind() == Token::kEnd || wrapped_;
    if (quantity_before || (is_first && is_last && !wrapped_)) return true;
    const bool leads = at_ + 1 < tokens_.size() && is_quantity(tokens_[at_ + 1]);
    if (leads && (is_first || begin_ < at_)) return true;
    if (of_comment) return false;
    return wrapped_ || (is_last && kind_before() == Token::kWord && !is_denied());
  }

 private:
  Token kind_before() const { return begin_ == 0 ? Token::kEnd : tokens_[begin_ - 1].kind; }
  Token kind_behind() const { return at_ + 1 >= tokens_.size() ? Token::kEnd : tokens_[at_ + 1].kind; }
  bool is_denied() const {
    constexpr std::array kDenials = {"not", "no", "never"};
    return is_in(tokens_[begin_ - 1].text, kDenials);
  }

  const std::vector<PercentToken>& tokens_;
  std::size_t at_, begin_;  // of the sign, and of what belongs to it: links, a bracket of its own
  bool wrapped_;
};

bool has_percent_unit(std::string_view text, bool of_comment) {
  const std::vector<PercentToken> tokens = percent_tokens(text);
  for (std::size_t at = 0; at < tokens.size(); ++at)
    if (tokens[at].kind == Token::kPercent && PercentSign(tokens, at).is_unit(of_comment)) return true;
  return false;
}

}  // namespace

bool says_percent(std::string_view name) {
  return has_percent_unit(name, false);
}

bool comment_says_percent(std::string_view comment) {
  return has_percent_unit(comment, true);
}

}  // namespace kiloband
