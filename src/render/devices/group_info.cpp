#include "render/devices/group_info.hpp"

#include <algorithm>
#include <set>

namespace kiloband {
namespace {

constexpr std::size_t kReportedInvalid = 16;

std::string joined(std::span<const BackendInfo> infos, std::string BackendInfo::*member,
                   const std::string& between) {
  std::set<std::string> different;
  for (const BackendInfo& info : infos) different.insert(info.*member);
  std::string text;
  for (const std::string& one : different) text += (text.empty() ? "" : between) + one;
  return text;
}

}  // namespace

BackendInfo joined_info(std::span<const BackendInfo> infos) {
  return {joined(infos, &BackendInfo::name, "+"), joined(infos, &BackendInfo::device, " + "),
          joined(infos, &BackendInfo::isa, " + "), joined(infos, &BackendInfo::method, " + ")};
}

bool of_one_kind(std::span<const BackendInfo> infos) {
  return std::ranges::all_of(infos, [&](const BackendInfo& info) {
    const BackendInfo& first = infos.front();
    return info.name == first.name && info.device == first.device && info.isa == first.isa &&
           info.method == first.method;
  });
}

void add_statistics(BackendStatistics& sum, const BackendStatistics& one) {
  sum.paths += one.paths;
  sum.vertices += one.vertices;
  sum.rays += one.rays;
  sum.invalid_samples += one.invalid_samples;
  for (const InvalidSample& sample : one.first_invalid)
    if (sum.first_invalid.size() < kReportedInvalid) sum.first_invalid.push_back(sample);
  for (const auto& [kernel, seconds] : one.kernel_seconds) sum.kernel_seconds[kernel] += seconds;
  for (const auto& [kernel, launches] : one.kernel_launches) sum.kernel_launches[kernel] += launches;
  sum.device_memory_bytes += one.device_memory_bytes;
  sum.pool_slots += one.pool_slots;
  sum.longest_launch_seconds = std::max(sum.longest_launch_seconds, one.longest_launch_seconds);
  sum.device_rounds += one.device_rounds;
  sum.device_waits += one.device_waits;
  sum.device_losses += one.device_losses;
}

}  // namespace kiloband
