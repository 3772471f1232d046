#include <fmt/format.h>

#include <cstring>
#include <fstream>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "files/atomic_file.hpp"
#include "render/checkpoint/fingerprint.hpp"
#include "validation/speed/errors.hpp"

namespace kiloband::speed {
namespace fs = std::filesystem;
namespace {

constexpr uint32_t kReplicates = 16;
constexpr uint64_t kSeed = 0x7265666572656e63;  // no case has it: those count from --seed
constexpr char kMagic[] = "kiloband reference 1";

/// What stands before the numbers: nothing of a file is believed that does not agree with all of it.
struct Header {
  char magic[24] = {};
  uint64_t fingerprint = 0, samples = 0, values = 0, checksum = 0;
};

uint64_t checksum_of(const std::vector<float>& values) {
  WordHash hash;
  hash.add_all(values);
  return hash.value();
}

Header header_of(uint64_t fingerprint, uint64_t samples, const std::vector<float>& values) {
  Header header{{}, fingerprint, samples, values.size(), checksum_of(values)};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  return header;
}

/// The means of all replicates; empty where the file is not there, or another reference's, or damaged.
std::vector<float> stored(const fs::path& file, uint64_t fingerprint, uint64_t samples, std::size_t count) {
  std::error_code none;
  if (fs::file_size(file, none) != sizeof(Header) + 4 * count || none) return {};
  std::ifstream stream(file, std::ios::binary);
  Header header;
  std::vector<float> values(count);
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(4 * count));
  const Header wanted = header_of(fingerprint, samples, values);
  return stream && std::memcmp(&header, &wanted, sizeof header) == 0 ? values : std::vector<float>{};
}

void store(const fs::path& file, uint64_t fingerprint, uint64_t samples, const std::vector<float>& values) {
  const Header header = header_of(fingerprint, samples, values);
  std::vector<char> bytes(sizeof header + 4 * values.size());
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, values.data(), 4 * values.size());
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) throw DeviceError(file.parent_path().string() + ": " + error.message());
  write_file_atomically(file, bytes);
}

Setup reference_setup(const Setup& of, uint64_t samples) {
  Setup setup;
  setup.scene = of.scene, setup.channels = of.channels, setup.width = of.width, setup.height = of.height;
  setup.depth = of.depth;
  setup.backend = "cpu", setup.wavelengths = "shared", setup.sampler = "sobol";
  setup.replicates = kReplicates;
  setup.samples = samples;
  return setup;
}

}  // namespace

Reference reference_of(const Bench& bench, const SceneFile& scene, const Setup& of, uint64_t samples) {
  const Setup setup = reference_setup(of, samples);
  const auto compiled = load(scene, setup);
  Subject subject = make_subject(bench.settings(), setup, compiled, kReplicates, kSeed);
  SamplingSettings sampling;
  sampling.seed = kSeed;
  const uint64_t fingerprint = render_fingerprint(*compiled, sampling, arithmetic_of(*subject.backend), {});
  const fs::path file =
      bench.settings().output / "references" / fmt::format("{}-{:016x}", scene.name, fingerprint);
  Reference reference;
  reference.samples = samples;
  reference.command = render_command(bench.settings(), scene, setup, kSeed, " --keep-replicates");
  for (const Channel& channel : compiled->channels)
    reference.centres_nm.push_back(0.5 * (channel.min_nm + channel.max_nm));
  stats::ReplicateImage& image = reference.image;
  image = {setup.width, setup.height, compiled->channels.size(), kReplicates, {}, {}};
  image.samples.assign(kReplicates * image.pixels(), samples / kReplicates);
  image.means = stored(file, fingerprint, samples, kReplicates * image.pixels() * image.channels);
  reference.reused = !image.means.empty();
  if (reference.reused) return reference;
  Setup one = setup;
  one.replicates = 1, one.samples = samples / kReplicates;
  const Repetitions rendered = repeat(subject, one, kReplicates, bench.watch());
  for (const std::vector<float>& r : rendered.images)
    image.means.insert(image.means.end(), r.begin(), r.end());
  if (!bench.stopped()) store(file, fingerprint, samples, image.means);
  return reference;
}

}  // namespace kiloband::speed
