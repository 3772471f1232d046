#include "render/checkpoint.hpp"

#include <fmt/core.h>

#include <array>
#include <cstring>
#include <fstream>

#include "film/atomic_file.hpp"

namespace kiloband {
namespace {

// Layout, little endian: magic, fingerprint, replicates, pixels, channels, blocks (u64 each); means; samples;
// attempted; block samples; block sums (those of empty blocks as zeros); checksum of all before it.
constexpr std::array<char, 16> kMagic{'k', 'i', 'l', 'o', 'b', 'a', 'n', 'd',
                                      ' ', 'c', 'h', 'e', 'c', 'k', ' ', '1'};

using CheckpointHeader = std::array<uint64_t, 5>;  // between magic and means
constexpr std::size_t kReplicatesEntry = 1;
constexpr uint64_t kMostReplicates = 4096;  // more are no checkpoint of ours

/// FNV-1a over 64-bit words (the rest bytewise): fast enough for gigabytes, and every bit counts.
class Hash {
 public:
  void add(std::span<const char> bytes) {
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
      uint64_t word;
      std::memcpy(&word, &bytes[i], 8);
      mix(word);
    }
    for (; i < bytes.size(); ++i) mix(static_cast<unsigned char>(bytes[i]));
  }
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add({reinterpret_cast<const char*>(&value), sizeof value});
  }
  template <class T>
  void add_all(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_value(values.size());
    add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }
  uint64_t value() const { return state_; }

 private:
  void mix(uint64_t word) {
    state_ = (state_ ^ word) * 0x100000001b3ull;
    state_ ^= state_ >> 29;  // the multiplication alone never carries high bits down
  }
  uint64_t state_ = 0xcbf29ce484222325ull;
};

void add_channels(Hash& hash, const ChannelList& channels) {
  hash.add_value(channels.size());
  for (const Channel& channel : channels) {
    hash.add_value(channel.min_nm);
    hash.add_value(channel.max_nm);
  }
}

void add_spectra(Hash& hash, const std::vector<SpectrumRow>& spectra) {
  for (const SpectrumRow& row : spectra) {
    hash.add_all(row.table.values);
    for (const double v : {row.table.min_nm, row.table.step_nm, row.temperature_k, row.planck_scale,
                           row.planck_min_nm, row.planck_max_nm}) {
      hash.add_value(v);
    }
    hash.add_value(row.is_planck);
    hash.add_value(row.is_emission);
    hash.add_value(row.table.extrapolate);
  }
}

/// Sequential output with a running checksum.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& file) : file_(file) {}
  void put(std::span<const char> bytes) {
    hash_.add(bytes);
    file_.write_at(offset_, bytes);
    offset_ += bytes.size();
  }
  template <class T>
  void put_all(std::span<const T> values) {
    put({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  void finish() {
    const uint64_t checksum = hash_.value();
    put_all(std::span<const uint64_t>(&checksum, 1));
    file_.commit();
  }

 private:
  AtomicFile file_;
  Hash hash_;
  uint64_t offset_ = 0;
};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : name_(file.string()), in_(file, std::ios::binary) {
    if (!in_) throw InputError(name_ + ": cannot be opened");
  }
  template <class T>
  void get_all(std::span<T> values) {
    const auto bytes = static_cast<std::streamsize>(values.size_bytes());
    if (!in_.read(reinterpret_cast<char*>(values.data()), bytes)) fail("is not a checkpoint or ends early");
    hash_.add({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  uint64_t get() {
    uint64_t value = 0;
    get_all(std::span<uint64_t>(&value, 1));
    return value;
  }
  CheckpointHeader get_header() {
    std::array<char, kMagic.size()> magic{};
    get_all<char>(magic);
    if (magic != kMagic) fail("is not a checkpoint");
    CheckpointHeader header{};
    get_all<uint64_t>(header);
    return header;
  }
  void check_end() {
    const uint64_t expected = hash_.value();
    if (get() != expected) fail("is damaged: the checksum differs");
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("checkpoint " + name_ + " " + what);
  }

 private:
  std::string name_;
  std::ifstream in_;
  Hash hash_;
};

void add_spectral_textures(Hash& hash, const FlatScene& scene) {
  for (const BandSet& set : scene.band_sets) {
    hash.add_all(set.centres_nm);
    for (const double value : {set.min_nm, set.max_nm, set.scale}) hash.add_value(value);
    hash.add_value(set.extrapolate);
  }
  for (const SpectralTexels& texels : scene.spectral_texels)
    if (texels) hash.add_all(*texels);
}

CheckpointHeader header_of(const SpectralFilm& film, uint64_t fingerprint) {
  return {fingerprint, film.options().replicates, film.rect().pixels(), film.options().channels,
          film.blocks().size()};
}

}  // namespace

uint64_t render_fingerprint(const FlatScene& scene, const SamplingSettings& sampling, const std::string& isa,
                            const DerivedChannels& derived) {
  Hash hash;
  add_channels(hash, scene.channels);
  add_channels(hash, scene.guide);
  add_spectra(hash, scene.spectra);
  hash.add_all(scene.textures);
  hash.add_all(scene.texels);
  add_spectral_textures(hash, scene);
  hash.add_all(scene.checkerboards);
  hash.add_all(scene.materials);
  hash.add_all(scene.thermals);
  hash.add_all(scene.thermal_tables);
  hash.add_all(scene.surfaces);
  hash.add_all(scene.shapes);
  hash.add_all(scene.positions);
  hash.add_all(scene.normals);
  hash.add_all(scene.uvs);
  hash.add_all(scene.triangles);
  hash.add_all(scene.emitters);
  hash.add_value(scene.camera);
  for (const uint32_t value :
       {scene.film.crop_x, scene.film.crop_y, scene.film.crop_width, scene.film.crop_height}) {
    hash.add_value(value);
  }
  hash.add_value(scene.integrator.max_depth);
  hash.add_value(scene.integrator.rr_depth);
  hash.add_value(scene.integrator.hide_emitters);
  hash.add_value(sampling.seed);
  hash.add_value(sampling.replicates);
  hash.add_value(static_cast<int>(sampling.sampler));
  hash.add_value(static_cast<int>(sampling.rough_dispersion));
  hash.add_value(static_cast<int>(sampling.wavelengths));
  hash.add({isa.data(), isa.size()});
  for (const std::string& name : derived.names) hash.add({name.data(), name.size()});
  for (const RegularTable& response : derived.responses) {
    hash.add_all(response.values);
    hash.add_value(response.min_nm);
    hash.add_value(response.step_nm);
    hash.add_value(response.extrapolate);
  }
  return hash.value();
}

void write_checkpoint(const std::filesystem::path& file, const SpectralFilm& film, uint64_t fingerprint) {
  Writer out(file);
  const HeldCountsView counts = film.held_counts();
  out.put(kMagic);
  out.put_all<uint64_t>(header_of(film, fingerprint));
  out.put_all<float>(film.held_means());
  for (const auto& samples : counts.samples) out.put_all<uint64_t>(samples);
  for (const auto& attempted : counts.attempted) out.put_all<uint32_t>(attempted);
  for (const auto& samples : counts.block_samples) out.put_all<uint64_t>(samples);
  const std::vector<double> empty(film.options().replicates * film.options().channels);
  for (const auto& sums : counts.block_sums) out.put_all<double>(sums.empty() ? empty : sums);
  out.finish();
}

bool checkpoint_exists(const std::filesystem::path& file) {
  std::error_code error;
  const bool exists = std::filesystem::exists(file, error);
  if (error) throw InputError(fmt::format("checkpoint {}: cannot be looked for: {}", file.string(), error.message()));
  return exists;
}

std::optional<uint32_t> checkpoint_replicates(const std::filesystem::path& file) {
  if (!checkpoint_exists(file)) return std::nullopt;
  const uint64_t replicates = Reader(file).get_header()[kReplicatesEntry];
  if (replicates < 1 || replicates > kMostReplicates) return std::nullopt;  // read_checkpoint() says so
  return static_cast<uint32_t>(replicates);
}

uint64_t read_checkpoint(const std::filesystem::path& file, SpectralFilm& film, uint64_t fingerprint) {
  Reader in(file);
  const CheckpointHeader expected = header_of(film, fingerprint), found = in.get_header();
  if (found != expected && found[kReplicatesEntry] != expected[kReplicatesEntry])
    in.fail(fmt::format("belongs to another render: it has {} replicates, this one {}",
                        found[kReplicatesEntry], expected[kReplicatesEntry]));
  if (found != expected)
    in.fail("belongs to another render: scene, channels, sampling, size or instruction set differ");
  HeldCounts counts = film.held_counts().copy();
  in.get_all<float>(film.held_means());
  for (auto& samples : counts.samples) in.get_all<uint64_t>(samples);
  for (auto& attempted : counts.attempted) in.get_all<uint32_t>(attempted);
  for (auto& samples : counts.block_samples) in.get_all<uint64_t>(samples);
  for (auto& sums : counts.block_sums) {
    sums.resize(film.options().replicates * film.options().channels);
    in.get_all<double>(sums);
  }
  in.check_end();
  uint64_t total = 0;
  for (const auto& samples : counts.samples) {
    for (const uint64_t n : samples) total += n;
  }
  film.restore(std::move(counts));
  return total;
}

}  // namespace kiloband
