#include "spectral/files/value_units.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "spectral/files/powers_of_ten.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/unit_names.hpp"

namespace kiloband {
namespace {

constexpr KnownUnit kAngstrom{"A", Dimension::kLength, 1e-10};  // behind a power, elsewhere a letter

struct Factor {
  Dimension dimension;
  double scale;
  int exponent;
};

/// Units joined to one; begin and end are places in the text that was parsed.
struct Run {
  std::vector<Factor> factors;
  std::size_t begin = 0, end = 0;
  bool divides = false;  // a slash, "per" or a negative exponent
  bool named = false;    // factors are joined by "_"
  bool is_cut = false;   // what follows at once belongs to it and is not understood: "m~2"

  std::size_t count(Dimension dimension) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(factors, [&](const Factor& f) { return f.dimension == dimension; }));
  }
  std::size_t sources() const { return count(Dimension::kPower) + count(Dimension::kEnergy); }
};

bool is_source(Dimension dimension) {
  return dimension == Dimension::kPower || dimension == Dimension::kEnergy;
}

/// Reads one run of units from a place on.
class RunParser {
 public:
  RunParser(std::string_view text, std::size_t at) : text_(text), at_(at) { run_.begin = run_.end = at; }

  Run parse() {
    expression(0);
    // "W_m2_nm": names of columns have no signs. All behind the power is below it.
    if (run_.named && !run_.divides && run_.count(Dimension::kPower) == 1)
      for (Factor& f : run_.factors)
        if (f.dimension != Dimension::kPower) f.exponent = -f.exponent;
    const char next = run_.end < text_.size() ? text_[run_.end] : ' ';
    run_.is_cut = next == '^' || is_ascii_digit(next) || static_cast<unsigned char>(next) >= 0x80;
    return run_;
  }

 private:
  char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

  void skip_blanks() {
    while (peek() == ' ' || peek() == '\t') ++at_;
  }

  /// "per" as a word, or a slash.
  bool take_division() {
    if (peek() == '/') return ++at_, true;
    const std::size_t word = peek() == '_' ? at_ + 1 : at_;
    if (lowered(text_.substr(word, 3)) != "per" || is_ascii_letter(peek(word + 3 - at_))) return false;
    at_ = word + 3;
    if (peek() == '_') ++at_;
    return true;
  }

  /// What may stand between two factors instead of a slash.
  void skip_product() {
    const bool joins = peek() == '*' || peek() == '.' || peek() == '-' || peek() == '_';
    if (!joins || (!is_ascii_letter(peek(1)) && peek(1) != '(')) return;
    run_.named = run_.named || (peek() == '_' && !run_.factors.empty());
    ++at_;
  }

  void append(const KnownUnit& unit, std::optional<int> exponent, int sign) {
    Factor factor{unit.dimension, unit.scale, exponent.value_or(1)};
    run_.divides = run_.divides || sign < 0 || factor.exponent < 0;
    if (unit.name == "cm" && factor.exponent == -1) factor = {Dimension::kWavenumber, 1, 1};
    factor.exponent *= sign;
    run_.factors.push_back(factor);
  }

  /// A unit, or a power and a length that nothing separates ("Wm-2").
  bool take_unit(bool below, bool divided) {
    std::size_t end = at_;
    while (end < text_.size() && is_ascii_letter(text_[end])) ++end;
    const std::string_view name = text_.substr(at_, end - at_);
    std::vector<KnownUnit> units;
    if (const auto unit = known_unit(name)) units = {*unit};
    if (name == "A" && run_.sources() > 0) units = {kAngstrom};
    const std::size_t watt = units.empty() ? name.substr(0, 2).find('W') : std::string_view::npos;
    if (watt != std::string_view::npos) {
      const auto power = known_unit(name.substr(0, watt + 1)), rest = known_unit(name.substr(watt + 1));
      if (power && rest) units = {*power, *rest};
    }
    const bool begins = run_.factors.empty() && !divided;
    if (units.empty() || (is_source(units.front().dimension) && !begins)) return false;
    at_ = end;
    const std::optional<int> exponent = take_exponent(text_, at_);
    const bool inverse = divided || (below && exponent.value_or(1) > 0);
    if (units.size() == 2) append(units.front(), std::nullopt, 1);
    append(units.back(), exponent, inverse ? -1 : 1);
    return true;
  }

  bool take_group(bool below, bool divided, int depth) {
    const std::size_t first = run_.factors.size();
    ++at_;
    expression(depth + 1);
    skip_blanks();
    if (run_.factors.size() == first || (peek() != ')' && peek() != ']')) return false;
    ++at_;
    const std::optional<int> exponent = take_exponent(text_, at_);
    const bool inverse = divided || (below && exponent.value_or(1) > 0);
    const int power = exponent.value_or(1) * (inverse ? -1 : 1);
    run_.divides = run_.divides || power < 0;
    for (std::size_t i = first; i < run_.factors.size(); ++i) run_.factors[i].exponent *= power;
    return true;
  }

  void expression(int depth) {
    constexpr int kMaxDepth = 4;
    bool below = false;
    if (peek() == '1' && run_.factors.empty()) ++at_;  // "1/m"
    for (;;) {
      const std::size_t before = at_;
      const std::size_t factors = run_.factors.size();
      skip_blanks();
      const bool divided = take_division();
      below = below || divided;
      if (divided)
        skip_blanks();
      else
        skip_product();
      const bool group = (peek() == '(' || peek() == '[') && depth < kMaxDepth;
      if (group ? take_group(below, divided, depth) : take_unit(below, divided)) {
        if (depth == 0) run_.end = at_;
        continue;
      }
      run_.factors.resize(factors);
      at_ = before;
      return;
    }
  }

  std::string_view text_;
  std::size_t at_;
  Run run_;
};

/// All runs of units, in order. A unit begins a word.
std::vector<Run> find_runs(std::string_view text) {
  std::vector<Run> runs;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char before = at == 0 ? ' ' : text[at - 1];
    const bool starts = is_ascii_letter(text[at]) || text[at] == '1';
    if (!starts || is_ascii_letter(before) || is_ascii_digit(before)) continue;
    Run run = RunParser(text, at).parse();
    if (run.factors.empty()) continue;
    at = std::max(at, run.end - 1);
    runs.push_back(std::move(run));
  }
  return runs;
}

bool is_power(const Run& run) {
  const bool counts = run.count(Dimension::kOther) > 0 && run.divides;
  return run.factors.size() >= 2 && (run.sources() > 0 || counts);
}

/// Area, solid angle and interval of a power; false where the factors are no such quantity.
bool take_factor(const Factor& f, ValueUnit& unit, int& intervals) {
  switch (f.dimension) {
    case Dimension::kPower:
    case Dimension::kEnergy:
      unit.factor *= f.scale;
      return f.exponent == 1;
    case Dimension::kTime:
      return f.exponent == -1;
    case Dimension::kSolidAngle:
      return f.exponent == -1 && !std::exchange(unit.per_solid_angle, true);
    case Dimension::kWavenumber:
      unit.per_wavenumber = true;
      return std::abs(f.exponent) == 1 && ++intervals == 1;
    case Dimension::kLength:
      break;
    default:
      return false;
  }
  if (f.exponent == 1 && f.scale == 1e-2) {  // W/m2 cm: per cm-1
    unit.per_wavenumber = true;
    return ++intervals == 1;
  }
  if (f.exponent == -2 || f.exponent == -3) {
    if (std::exchange(unit.per_area, true)) return false;
    unit.factor /= f.scale * f.scale;
  }
  if (f.exponent == -2) return true;
  unit.factor /= f.scale * 1e9;  // per nm
  return (f.exponent == -1 || f.exponent == -3) && ++intervals == 1;
}

/// Its place in the text, from a power of ten before it to one behind it, which nothing here multiplies by: some write what
/// the values were multiplied by, some what they are to be.
ValueUnit unit_at(const Run& run, std::string_view text) {
  const auto [begin, end] = with_powers_of_ten(text, run.begin, run.end, PlainPowers::kInBrackets);
  ValueUnit unit;
  unit.text = std::string(text.substr(begin, end - begin));
  unit.factors = run.factors.size();
  unit.is_scaled = begin != run.begin || end != run.end;
  unit.is_understood = !run.is_cut;
  return unit;
}

ValueUnit power_unit(const Run& run, std::string_view text) {
  ValueUnit unit = unit_at(run, text);
  int intervals = 0;
  for (const Factor& factor : run.factors)
    unit.is_understood = take_factor(factor, unit, intervals) && unit.is_understood;
  const std::size_t energies = run.count(Dimension::kEnergy), times = run.count(Dimension::kTime);
  const bool power = run.count(Dimension::kPower) + energies == 1 && energies == times;
  unit.is_understood = unit.is_understood && power && intervals == 1;
  return unit;
}

}  // namespace

std::optional<ValueUnit> find_power_unit(std::string_view text) {
  const std::string plain = units_in_ascii(text);
  std::optional<ValueUnit> first;
  for (const Run& run : find_runs(plain)) {
    if (!is_power(run)) continue;
    ValueUnit unit = power_unit(run, plain);
    if (unit.is_understood) return unit;
    if (!first) first = std::move(unit);
  }
  return first;
}

std::optional<ValueUnit> find_inverse_length(std::string_view text) {
  const std::string plain = units_in_ascii(text);
  for (const Run& run : find_runs(plain)) {
    const std::size_t lengths = run.count(Dimension::kLength) + run.count(Dimension::kWavenumber);
    const bool power_of_length = run.divides || run.factors.front().exponent != 1;
    if (!power_of_length || (lengths == 0 && run.count(Dimension::kOther) == 0)) continue;
    ValueUnit unit = unit_at(run, plain);
    const Factor& only = run.factors.front();
    if (only.dimension == Dimension::kWavenumber) unit.factor = 100;
    if (only.dimension == Dimension::kLength) unit.factor = 1 / only.scale;
    unit.is_understood = unit.is_understood && run.factors.size() == 1 && lengths == 1 &&
                         only.exponent == (only.dimension == Dimension::kWavenumber ? 1 : -1);
    return unit;
  }
  return std::nullopt;
}

std::string without_power_units(std::string_view text) {
  std::string plain = units_in_ascii(text);
  std::vector<Run> runs = find_runs(plain);
  for (auto run = runs.rbegin(); run != runs.rend(); ++run)
    if (is_power(*run)) plain.replace(run->begin, run->end - run->begin, 1, ' ');
  return plain;
}

}  // namespace kiloband
