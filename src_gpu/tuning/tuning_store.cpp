#include "src_gpu/tuning/tuning_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/json_dump.hpp"
#include "files/atomic_file.hpp"
#include "files/folder_claim.hpp"
#include "files/input_file.hpp"
#include "src_gpu/device/user_cache.hpp"

namespace kiloband::opencl {
namespace {

using nlohmann::json;

/// What the numbers in a file mean.
constexpr int kFormat = 2;
/// No device has more, or gains from less.
constexpr uint64_t kFewestKept = 64, kMostPaths = uint64_t{1} << 28, kLargestGroup = 4096;

constexpr uint64_t kLargestFile = uint64_t{1} << 20;  // bytes: hundreds of measurements
constexpr const char* kNoFolder = "there is no folder for it: neither XDG_CACHE_HOME nor HOME is set";

/// A conversion of other numbers is undefined where they are too large.
uint64_t whole_number(const json& from, const char* name) {
  if (!from.at(name).is_number_unsigned()) throw std::out_of_range(name);
  return from.at(name).get<uint64_t>();
}

template <class T>
std::optional<T> size_in(const json& from, const char* name, uint64_t fewest, uint64_t most) {
  if (!from.contains(name)) return std::nullopt;
  const auto value = whole_number(from, name);
  if (value < fewest || value > most) throw std::out_of_range(name);
  return static_cast<T>(value);
}

template <class T>
void put(json& to, const char* name, const std::optional<T>& value) {
  if (value) to[name] = *value;
}

TunedMethod tuned_method(const json& from) {
  TunedMethod one;
  one.method = from.at("method").get<std::string>();
  one.channels = static_cast<uint32_t>(std::min<uint64_t>(whole_number(from, "channels"), ~0u));
  if (one.channels == 0) throw std::out_of_range("channels");
  one.items_of_path = size_in<uint32_t>(from, "items_of_path", 1, kLargestGroup).value_or(1);
  one.scene = from.at("scene").get<std::string>();
  one.speed_up = from.at("speed_up").get<double>();
  one.tuning.pool_slots = size_in<uint32_t>(from, "pool_slots", kFewestKept, kMostPaths);
  one.tuning.round_paths = size_in<uint64_t>(from, "round_paths", kFewestKept, kMostPaths);
  one.tuning.path_group = size_in<uint32_t>(from, "path_group", 1, kLargestGroup);
  one.tuning.evaluation_group = size_in<uint32_t>(from, "evaluation_group", 1, kLargestGroup);
  return one;
}

json tuned_json(const TunedMethod& one) {
  json j{{"method", one.method},
         {"channels", one.channels},
         {"items_of_path", one.items_of_path},
         {"scene", one.scene},
         {"speed_up", one.speed_up}};
  put(j, "pool_slots", one.tuning.pool_slots);
  put(j, "round_paths", one.tuning.round_paths);
  put(j, "path_group", one.tuning.path_group);
  put(j, "evaluation_group", one.tuning.evaluation_group);
  return j;
}

}  // namespace

TuningStore TuningStore::of_user() {
  return TuningStore(user_cache("tuning"));
}

std::filesystem::path TuningStore::file(const DeviceInfo& device) const {
  if (folder_.empty()) return {};
  std::string all =
      joined_parts({device.name, device.driver_version, device.platform, device.platform_version});
  all += fmt::format("{} units", device.compute_units);  // of a part fewer than of the whole
  return folder_ / (text_hash(all) + ".json");
}

std::vector<TunedMethod> TuningStore::load(const DeviceInfo& device) const {
  std::vector<TunedMethod> tuned;
  try {
    const json all = json::parse(read_small_file(file(device), kLargestFile));
    if (all.at("format") != kFormat || all.at("device") != json_text<json>(device.name)) return {};
    for (const json& one : all.at("tuned")) tuned.push_back(tuned_method(one));
  } catch (const InputError&) {
    return {};
  } catch (const DeviceError&) {
    return {};
  } catch (const json::exception&) {
    return {};
  } catch (const std::out_of_range&) {
    return {};
  }
  return tuned;
}

std::string TuningStore::refusal(const DeviceInfo& device) const {
  if (folder_.empty()) return kNoFolder;
  if (std::string no_folder = make_cache_folder(folder_); !no_folder.empty()) return no_folder;
  try {
    check_writable(file(device));
  } catch (const DeviceError& error) {
    return error.what();
  }
  return {};
}

std::string TuningStore::save(const DeviceInfo& device, const TunedMethod& measured) const {
  if (folder_.empty()) return kNoFolder;
  if (std::string no_folder = make_cache_folder(folder_); !no_folder.empty()) return no_folder;
  const FolderClaim claim(
      folder_);  // or another process's measurement, kept between load() and here, would be lost
  std::vector<TunedMethod> tuned = load(device);
  std::erase_if(tuned, [&](const TunedMethod& one) {
    return one.method == measured.method && one.channels == measured.channels;
  });
  tuned.push_back(measured);
  json all{{"format", kFormat}, {"device", device.name}, {"driver", device.driver_version}};
  for (const TunedMethod& one : tuned) all["tuned"].push_back(tuned_json(one));
  // Names of devices, scenes too, may be in any encoding.
  return keep_file(file(device), dump_json(all, 2) + "\n");
}

bool TuningStore::forget(const DeviceInfo& device) const {
  if (folder_.empty()) return false;
  std::error_code error;
  const bool had = std::filesystem::remove(file(device), error);
  if (error == std::errc::not_a_directory) return false;  // as without the folder
  if (error) throw DeviceError("cannot remove '" + file(device).string() + "': " + error.message());
  return had;
}

}  // namespace kiloband::opencl
