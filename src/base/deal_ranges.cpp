#include "base/deal_ranges.hpp"

#include <algorithm>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace kiloband {
namespace {

constexpr uint64_t kBytesOfThread = uint64_t{1} << 20;

unsigned processors() {
  return std::max(std::thread::hardware_concurrency(), 1u);
}

}  // namespace

unsigned threads_for(uint64_t bytes) {
  return static_cast<unsigned>(std::clamp<uint64_t>(bytes / kBytesOfThread, 1, processors()));
}

void deal_ranges(std::size_t items, unsigned threads,
                 const std::function<void(std::size_t, std::size_t)>& work) {
  const std::size_t parts = std::min<std::size_t>(std::max(threads, 1u), items);
  if (parts <= 1) {
    if (items > 0) work(0, items);
    return;
  }
  std::vector<std::exception_ptr> failures(parts);
  const auto do_part = [&](std::size_t part) {
    try {
      work(items * part / parts, items * (part + 1) / parts);
    } catch (...) {
      failures[part] = std::current_exception();
    }
  };
  std::size_t dealt = 1;  // the first is the caller's
  {
    std::vector<std::jthread> others;
    others.reserve(parts - 1);
    try {
      for (; dealt < parts; ++dealt) others.emplace_back(do_part, dealt);
    } catch (const std::system_error&) {  // no more threads
    }
    do_part(0);
    for (; dealt < parts; ++dealt) do_part(dealt);
  }
  const auto failed = std::ranges::find_if(failures, [](const auto& failure) { return failure != nullptr; });
  if (failed != failures.end()) std::rethrow_exception(*failed);
}

void deal_items(std::size_t items, const std::function<void(std::size_t)>& work) {
  const std::size_t parts = std::min<std::size_t>(processors(), items);
  deal_ranges(parts, static_cast<unsigned>(parts), [&](std::size_t first, std::size_t end) {
    for (std::size_t part = first; part < end; ++part)
      for (std::size_t item = part; item < items; item += parts) work(item);
  });
}

}  // namespace kiloband
