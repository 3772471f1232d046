// Work on many items by a few threads that live no longer than it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace kiloband {

/// Threads that moving `bytes` of memory is worth: one for every MiB, at most one per processor, at least 1.
unsigned threads_for(uint64_t bytes);

/// Deals items 0 .. items - 1 to at most `threads` threads, the caller's among them, in order and in equal parts: work(first, end) for
/// items first .. end - 1. Parts of threads that the system refuses are the caller's. Returns when all are done.
/// throws what the first of the parts threw that threw anything; the other parts have been worked on
void deal_ranges(std::size_t items, unsigned threads,
                 const std::function<void(std::size_t first, std::size_t end)>& work);

/// The same one by one, on all of the processor's threads: work(item). Neighbours are different threads', so that none of them gets all
/// that take long.
void deal_items(std::size_t items, const std::function<void(std::size_t item)>& work);

}  // namespace kiloband
