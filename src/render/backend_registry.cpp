#include "render/backend_registry.hpp"

#include <algorithm>
#include <mutex>

#include "base/error.hpp"
#include "render/devices/device_group.hpp"

namespace kiloband {
namespace {

/// For devices that render at the same time.
DiagnosticSink one_at_a_time(const DiagnosticSink& sink) {
  if (!sink) return {};
  return [sink, mutex = std::make_shared<std::mutex>()](const Diagnostic& diagnostic) {
    const std::lock_guard lock(*mutex);
    sink(diagnostic);
  };
}

}  // namespace

std::vector<std::string> BackendRegistry::names() const {
  std::vector<std::string> names;
  for (const BackendEntry& entry : entries_) {
    names.push_back(entry.name);
    for (const std::string& method : entry.methods) names.push_back(entry.name + ":" + method);
  }
  return names;
}

BackendRegistry::Named BackendRegistry::find(const std::string& text) const {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  std::optional<std::string> method;
  if (colon != std::string::npos) method = text.substr(colon + 1);
  const auto entry = std::ranges::find(entries_, name, &BackendEntry::name);
  if (entry == entries_.end() ||
      (method && std::ranges::find(entry->methods, *method) == entry->methods.end())) {
    std::string all;
    for (const std::string& one : names()) all += (all.empty() ? "" : ", ") + one;
    throw InputError("no backend '" + text + "'; there are: " + all);
  }
  return {&*entry, method};
}

/// In the order in which they are made: the CPU backend is the last, which renders in the caller's thread.
std::vector<BackendRegistry::Named> BackendRegistry::find_all(const std::string& names) const {
  std::vector<Named> found;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t plus = std::min(names.find('+', begin), names.size());
    const Named one = find(names.substr(begin, plus - begin));
    if (std::ranges::find(found, one.first, &Named::first) != found.end())
      throw InputError("backend '" + names + "': " + one.first->name + " is named twice");
    found.push_back(one);
    begin = plus + 1;
  }
  std::ranges::stable_sort(found, {}, [](const Named& one) { return one.first->name == "cpu"; });
  return found;
}

std::unique_ptr<Backend> BackendRegistry::make(const BackendRequest& request,
                                               const BackendInput& input) const {
  BackendRequest each = request;
  each.sink = one_at_a_time(request.sink);
  std::vector<std::unique_ptr<Backend>> backends;
  const std::vector<Named> all = find_all(request.backend);
  for (std::size_t i = 0; i < all.size(); ++i) {
    each.reserved_threads = static_cast<int>(backends.size());
    try {
      for (auto& backend : all[i].first->make(input, each, all[i].second))
        backends.push_back(std::move(backend));
    } catch (const DeviceError& failure) {
      const bool last_hope = backends.empty() && i + 1 == all.size();
      if (last_hope) throw;
      warn(each.sink, {}, std::string(failure.what()) + ": the render goes without it");
    }
  }
  if (backends.size() == 1) return std::move(backends.front());
  return make_device_group(std::move(backends), each.sink);
}

}  // namespace kiloband
