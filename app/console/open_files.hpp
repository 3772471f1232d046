// How many files the program may have open.
#pragma once

#include <sys/resource.h>

namespace kiloband {

/// A cube with its replicates is up to 4096 pairs of files, all open at once; the usual limit is 1024, which a program may raise by
/// itself as far as the hard limit goes. Where it may not, opening says so.
inline void allow_many_open_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace kiloband
