#include "app/console/run_progress.hpp"

#include <unistd.h>

#include <algorithm>

#include "app/console/messages.hpp"

namespace kiloband {

RunProgress::RunProgress(bool enabled) : enabled_(enabled), terminal_(isatty(2)) {}

void RunProgress::begin(const std::string& name) {
  name_ = name;
  if (enabled_ && !terminal_) tell("{:3.0f} %  {}\n", 100 * fraction_, name_);
}

void RunProgress::update(double fraction) {
  fraction_ = fraction;
  if (!enabled_ || !terminal_) return;
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(kWidth * std::clamp(fraction, 0.0, 1.0));
  tell("\r[{:#<{}}{:.<{}}] {:3.0f} %  {:<44.44}", "", filled, "", kWidth - filled, 100 * fraction, name_);
}

void RunProgress::end() const {
  if (enabled_ && terminal_) tell("\n");
}

}  // namespace kiloband
