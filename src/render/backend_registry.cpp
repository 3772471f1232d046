#include "render/backend_registry.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace kiloband {

std::vector<std::string> BackendRegistry::names() const {
  std::vector<std::string> names;
  for (const BackendEntry& entry : entries_) {
    names.push_back(entry.name);
    for (const std::string& method : entry.methods) names.push_back(entry.name + ":" + method);
  }
  return names;
}

std::unique_ptr<Backend> BackendRegistry::make(const BackendRequest& request,
                                               const BackendInput& input) const {
  const std::size_t colon = request.backend.find(':');
  const std::string name = request.backend.substr(0, colon);
  std::optional<std::string> method;
  if (colon != std::string::npos) method = request.backend.substr(colon + 1);
  const auto entry = std::ranges::find(entries_, name, &BackendEntry::name);
  if (entry == entries_.end() ||
      (method && std::ranges::find(entry->methods, *method) == entry->methods.end())) {
    std::string all;
    for (const std::string& one : names()) all += (all.empty() ? "" : ", ") + one;
    throw InputError("no backend '" + request.backend + "'; there are: " + all);
  }
  return entry->make(input, request, method);
}

}  // namespace kiloband
