#include "render/checkpoint/checkpoint.hpp"

#include <fmt/core.h>
#include <sys/stat.h>

#include <stdexcept>
#include <vector>

#include "base/error.hpp"
#include "files/atomic_file.hpp"
#include "render/checkpoint/checkpoint_reader.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

/// Sequential output with a running checksum.
class Writer {
 public:
  Writer(const std::filesystem::path& file, uint64_t bytes) : file_(file) {
    file_.preallocate(bytes);
    buffer_.reserve(kBufferBytes);
  }
  void put(std::span<const char> bytes) {
    hash_.add(bytes);
    if (buffer_.size() + bytes.size() > kBufferBytes) flush();
    if (bytes.size() > kBufferBytes) {
      file_.write_at(offset_, bytes);
      offset_ += bytes.size();
    } else {
      buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    }
  }
  template <class T>
  void put_all(std::span<const T> values) {
    put({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  void put_checksum() {
    const uint64_t checksum = hash_.value();
    put_all(std::span<const uint64_t>(&checksum, 1));
  }
  void commit() {
    flush();
    file_.commit();
  }

 private:
  void flush() {
    file_.write_at(offset_, buffer_);
    offset_ += buffer_.size();
    buffer_.clear();
  }

  AtomicFile file_;
  WordHash hash_;
  std::vector<char> buffer_;
  uint64_t offset_ = 0;
};

CheckpointHeader header_of(const SpectralFilm& film, uint64_t fingerprint) {
  const PixelRect& rect = film.rect();
  const SumRule& rule = *film.options().sums;
  return {fingerprint,
          rect.x0,
          rect.y0,
          rect.width,
          rect.height,
          film.options().channels,
          film.options().replicates,
          static_cast<uint64_t>(rule.kind),
          rule.chunk,
          rule.period};
}

/// Calls each(replicate, block, samples per pixel) of every replicate and block.
template <class Each>
void for_blocks(const SpectralFilm& film, const Each& each) {
  for (uint32_t r = 0; r < film.options().replicates; ++r) {
    for (uint32_t b = 0; b < film.blocks().size(); ++b) each(r, b, film.attempted(r, b));
  }
}

uint64_t bytes_of(const SpectralFilm& film) {
  uint64_t bytes = kCheckpointMagic.size() + (kCheckpointEntries + 1 + 2) * sizeof(uint64_t);
  for_blocks(film, [&](uint32_t, uint32_t b, uint32_t samples) {
    bytes += sizeof(uint32_t);
    if (samples > 0)
      bytes += film.blocks()[b].pixels() *
               checkpoint_pixel_bytes(*film.options().sums, film.options().channels, samples);
  });
  return bytes;
}

/// Returns the number of values that are not finite.
uint64_t put_block(Writer& out, const SpectralFilm& film, uint32_t replicate, uint32_t block) {
  const SumRule& rule = *film.options().sums;
  const PixelRect& rect = film.blocks()[block];
  const bool closed = film.attempted(replicate, block) > rule.chunk;
  const auto sums_of = [&](std::size_t p) { return film.pixel_sums(replicate, film.pixel_index(rect, p)); };
  std::vector<uint32_t> counts;
  for (std::size_t p = 0; p < rect.pixels(); ++p) counts.push_back(sums_of(p).count);
  out.put_all<uint32_t>(counts);
  uint64_t not_finite = 0;
  for (std::size_t p = 0; p < rect.pixels(); ++p) {
    PixelSumsView sums = sums_of(p);
    if (!closed) sums.closed = {};
    out.put_all(sums.open);
    out.put_all(sums.closed);
    not_finite += count_not_finite(rule, sums);
  }
  return not_finite;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const SpectralFilm& film, uint64_t fingerprint) {
  if (!film.keeps_sums() || !film.options().held)
    throw std::logic_error("write_checkpoint: the film does not hold sums");
  Writer out(file, bytes_of(film));
  out.put(kCheckpointMagic);
  out.put_all<uint64_t>(header_of(film, fingerprint));
  out.put_checksum();
  std::vector<uint32_t> attempted;
  for_blocks(film, [&](uint32_t, uint32_t, uint32_t samples) { attempted.push_back(samples); });
  out.put_all<uint32_t>(attempted);
  uint64_t not_finite = 0;
  for_blocks(film, [&](uint32_t r, uint32_t b, uint32_t samples) {
    if (samples > 0) not_finite += put_block(out, film, r, b);
  });
  out.put_all(std::span<const uint64_t>(&not_finite, 1));
  out.put_checksum();
  out.commit();
}

CheckpointOutline checkpoint_outline(const std::filesystem::path& file) {
  return CheckpointReader(file).outline();
}

bool checkpoint_exists(const std::filesystem::path& file) {
  std::error_code error;
  const bool exists = std::filesystem::exists(file, error);
  if (error)
    throw InputError(fmt::format("checkpoint {}: cannot be looked for: {}", file.string(), error.message()));
  return exists;
}

std::optional<uint32_t> checkpoint_replicates(const std::filesystem::path& file) {
  if (!checkpoint_exists(file)) return std::nullopt;
  return checkpoint_outline(file).replicates;
}

uint64_t read_checkpoint(const std::filesystem::path& file, SpectralFilm& film, uint64_t fingerprint) {
  CheckpointReader in(file);
  const CheckpointOutline& found = in.outline();
  const CheckpointHeader expected = header_of(film, fingerprint);
  if (found.replicates != expected[kEntryReplicates])
    in.fail("belongs to another render: it has " + std::to_string(found.replicates) +
            " replicates, this one " + std::to_string(expected[kEntryReplicates]));
  const CheckpointHeader header{
      found.fingerprint, found.rect.x0,    found.rect.y0,    found.rect.width,
      found.rect.height, found.channels,   found.replicates, static_cast<uint64_t>(found.rule.kind),
      found.rule.chunk,  found.rule.period};
  if (header != expected)
    in.fail(
        "belongs to another render: scene, channels, sampling, size, instruction set or OpenCL device "
        "differ");
  if (found.most_samples > film.options().most_samples)
    throw std::logic_error("read_checkpoint: the film has no room for as many samples");
  in.read_sums([&](uint32_t replicate, std::size_t pixel) { return film.pixel_sums(replicate, pixel); });
  for_blocks(film, [&](uint32_t r, uint32_t b, uint32_t) { film.set_attempted(r, b, in.attempted(r, b)); });
  return found.pixel_samples;
}

void check_checkpoint_file(const std::filesystem::path& file, bool resume) {
  struct stat status {};
  if (stat(file.c_str(), &status) == 0) {
    const std::string name = "--checkpoint " + file.string() + ": ";
    if (const std::string kind = irregular_kind(status.st_mode); !kind.empty())
      throw InputError(name + kind + ": must be a regular file, or not be there yet");
    if (!resume) throw InputError(name + "exists: --resume goes on from it; remove it to render anew");
  }
  check_writable(file);
}

}  // namespace kiloband
