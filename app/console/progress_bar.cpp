#include "app/console/progress_bar.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "app/console/messages.hpp"

namespace kiloband {
namespace {

constexpr int kBarWidth = 30;

std::string duration(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s", seconds);
  if (seconds < 6000) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string rate(double per_second) {
  if (per_second >= 1e6) return fmt::format("{:.2f} Mpaths/s", per_second * 1e-6);
  return fmt::format("{:.1f} kpaths/s", per_second * 1e-3);
}

}  // namespace

std::string describe(const Progress& progress) {
  std::string text = fmt::format("{:3.0f} %", 100 * progress.fraction);
  if (progress.rate > 0) text += "  " + rate(progress.rate);
  if (progress.fraction > 0.001 && progress.fraction < 1) {
    text += "  " + duration(progress.seconds * (1 - progress.fraction) / progress.fraction) + " left";
  }
  if (progress.error) text += fmt::format("  worst channel's error {:.2g} %", 100 * *progress.error);
  return text;
}

ProgressBar::ProgressBar(bool enabled)
    : enabled_(enabled),
      terminal_(isatty(STDERR_FILENO) == 1),
      last_print_(std::chrono::steady_clock::now()),
      interval_seconds_(terminal_ ? 0.1 : 10.0) {}

void ProgressBar::update(const Progress& progress) {
  last_ = progress;
  if (!enabled_) return;
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - last_print_).count() < interval_seconds_) return;
  last_print_ = now;
  print(progress);
}

void ProgressBar::print(const Progress& progress) const {
  if (!terminal_) {
    tell("{}\n", describe(progress));
    return;
  }
  const int filled = static_cast<int>(std::lround(std::clamp(progress.fraction, 0.0, 1.0) * kBarWidth));
  tell("\r[{}{}] {}\x1b[K", std::string(filled, '#'), std::string(kBarWidth - filled, '.'),
       describe(progress));
}

void ProgressBar::finish(const Progress& last) {
  if (!enabled_) return;
  print(last);
  if (terminal_) tell("\n");
}

}  // namespace kiloband
