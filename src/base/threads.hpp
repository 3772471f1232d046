// What the system allows of threads, asked before libraries need them: TBB, libgomp and PoCL end the process
// where they cannot have one.
#pragma once

#include <string>

namespace kiloband {

/// Whether this process may have `count` more threads at the same time: they are started and ended.
bool can_start_threads(unsigned count);

/// user    who needs them, "the CPU backend"
/// advice  what else may be done about it, "give fewer --threads"
/// throws DeviceError  the system refuses: says which limits there are
void require_threads(unsigned count, const std::string& user, const std::string& advice);

/// "the system starts no more (Resource temporarily unavailable): the limit of processes and threads of this
/// user (ulimit -u: 64) or of its container is reached".
std::string thread_limit_text();

}  // namespace kiloband
