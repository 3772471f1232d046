#include "src_gpu/evaluate/device_film.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "base/deal_ranges.hpp"

namespace kiloband::opencl {
namespace {

constexpr uint64_t kFilmGroup = 64;
/// Film values that a launch over all columns takes: 8 MiB.
constexpr uint64_t kItemsAtOnce = 1u << 20;
/// Values are downloaded in pieces of at most this many bytes and at most this part of the film,
/// unless that is little.
constexpr uint64_t kPieceBytes = 16u << 20, kPieces = 16, kLittle = 16u << 10;

uint64_t pixels_of_piece(const KbSpectraLayout& layout, uint64_t film_pixels) {
  const uint64_t bytes = sizeof(float) * film_values(layout);
  const uint64_t pixels = std::clamp(film_pixels / kPieces, kLittle / bytes, kPieceBytes / bytes);
  return std::clamp<uint64_t>(pixels, 1, film_pixels);
}

ProgramOptions program_options(const FilmForm& form, bool cache) {
  ProgramOptions options;
  if (form.transposed) options.defines.emplace_back("KB_FILM_TRANSPOSED=1");
  options.disk_cache = cache;
  return options;
}

}  // namespace

uint64_t film_values(const KbSpectraLayout& layout) {
  return uint64_t{layout.channels} + layout.derived;
}

uint64_t DeviceFilm::bytes_per_pixel(const KbSpectraLayout& layout, const FilmForm& form) {
  return (form.open ? 3 : 2) * sizeof(float) * uint64_t{layout.film_columns} + sizeof(uint32_t);
}

DeviceFilm::DeviceFilm(DeviceContext& context, DeviceMemory& memory, const KbSpectraLayout& layout,
                       const DeviceBuffer<KbSpectraLayout>& device_layout, const FilmForm& form,
                       bool program_cache, uint64_t pixels)
    : layout_(layout),
      device_layout_(device_layout),
      form_(form),
      pixels_(pixels),
      packed_pixels_(pixels_of_piece(layout, pixels)),
      sum_(memory.allocate<float>("film", pixels * layout.film_columns)),
      compensation_(memory.allocate<float>("film's rounding errors", pixels * layout.film_columns)),
      open_(memory.allocate<float>("sums of chunks", form.open ? sum_.size() : 0)),
      packed_(memory.allocate<float>("means", packed_pixels_ * film_values(layout))),
      counts_(memory.allocate<uint32_t>("sample counts", pixels)),
      landing_{{context, packed_.size()}, {context, packed_.size()}},
      program_(build_program(context, "film/film.cl", program_options(form, program_cache))),
      clear_(program_.kernel("film_clear")),
      finish_(program_.kernel("film_finish")),
      close_(program_.kernel("film_close")),
      pack_(program_.kernel("film_pack")),
      unpack_(program_.kernel("film_unpack")) {}

FilmArguments::Of<BufferRef> DeviceFilm::arguments(uint64_t first_pixel, bool open) const {
  return {.sum = open ? open_ : sum_,
          .compensation = compensation_,
          .counts = counts_,
          .pixels = static_cast<uint32_t>(pixels_),
          .first = static_cast<uint32_t>(first_pixel)};
}

PackingArguments::Of<BufferRef> DeviceFilm::packing(const DeviceBuffer<float>& values,
                                                    uint64_t pixels) const {
  return {.layout = device_layout_,
          .open = open_,
          .values = values,
          .packed = packed_,
          .pixels = static_cast<uint32_t>(pixels)};
}

/// Film pixels whose values stand among those of the first `pixels`.
uint64_t DeviceFilm::touched_pixels(uint64_t pixels) const {
  return form_.transposed ? pixels_ : pixels;
}

/// A work-item for every value of the first `pixels`.
void DeviceFilm::launch_over(FilmKernel& kernel, const DeviceBuffer<float>& values, uint64_t pixels) {
  const uint64_t touched = touched_pixels(pixels), items = touched * layout_.film_columns;
  kernel.set(arguments(0), packing(values, touched));
  for (uint64_t first = 0; first < items; first += kItemsAtOnce)
    kernel->launch(std::min(kItemsAtOnce, items - first), kFilmGroup, first);
}

void DeviceFilm::clear(uint64_t pixels) {
  launch_over(clear_, sum_, pixels);
  if (!open_.empty()) open_.fill(0.0f, 0, touched_pixels(pixels) * layout_.film_columns);
}

void DeviceFilm::close_chunk(uint64_t pixels) {
  launch_over(close_, open_, pixels);
}

void DeviceFilm::unpack(const std::vector<float>& packed, DeviceBuffer<float>& values) {
  const uint64_t of_pixel = film_values(layout_), pixels = packed.size() / of_pixel;
  for (uint64_t first = 0; first < pixels; first += packed_pixels_) {
    const uint64_t some = std::min(packed_pixels_, pixels - first);
    packed_.upload(std::span(packed).subspan(first * of_pixel, some * of_pixel));
    unpack_.set(arguments(first), packing(values, some));
    unpack_->launch(some * of_pixel, kFilmGroup);
  }
}

/// Film pixels, packed by `kernel` from `values`, piece by piece: while one comes down the host puts the one before in its place.
void DeviceFilm::download_packed(FilmKernel& kernel, const DeviceBuffer<float>& values, const Pixels& pixels,
                                 std::vector<float>& packed) {
  const uint64_t of_pixel = film_values(layout_);
  packed.resize(pixels.number * of_pixel);
  struct Piece {
    std::span<float> from;
    float* to;
    cl::Event done;
  };
  std::optional<Piece> before;
  const auto put = [&](const Piece& piece) {
    packed_.wait_for(piece.done);
    deal_ranges(piece.from.size(), threads_for(piece.from.size_bytes()),
                [&](std::size_t begin, std::size_t end) {
                  std::copy(piece.from.begin() + static_cast<std::ptrdiff_t>(begin),
                            piece.from.begin() + static_cast<std::ptrdiff_t>(end), piece.to + begin);
                });
  };
  for (uint64_t at = 0, number = 0; at < pixels.number; at += packed_pixels_, ++number) {
    const uint64_t some = std::min(packed_pixels_, pixels.number - at);
    kernel.set(arguments(pixels.first + at), packing(values, some));
    kernel->launch(some * of_pixel, kFilmGroup);
    const std::span<float> from = landing_[number % 2].values().first(some * of_pixel);
    const DeviceBuffer<float>& device_packed = packed_;
    Piece piece{from, packed.data() + at * of_pixel, device_packed.download_event(from)};
    if (before) put(*before);
    before = std::move(piece);
  }
  if (before) put(*before);
}

void DeviceFilm::pack(const Pixels& pixels, const DeviceBuffer<float>& values, std::vector<float>& packed) {
  download_packed(pack_, values, pixels, packed);
}

void DeviceFilm::download_counts(uint64_t pixels, std::vector<uint32_t>& counts) const {
  counts.resize(pixels);
  counts_.download(std::span<uint32_t>(counts));
}

void DeviceFilm::load(const FilmSums& sums) {
  unpack(sums.open, open_);
  unpack(sums.sum, sum_);
  unpack(sums.lost, compensation_);
  counts_.upload(std::span(sums.counts));
}

void DeviceFilm::save(uint64_t pixels, FilmSums& sums) {
  pack({0, pixels}, open_, sums.open);
  pack({0, pixels}, sum_, sums.sum);
  pack({0, pixels}, compensation_, sums.lost);
  download_counts(pixels, sums.counts);
}

void DeviceFilm::finish(uint64_t pixels, std::vector<float>& means, std::vector<uint32_t>& counts) {
  download_packed(finish_, sum_, {0, pixels}, means);
  download_counts(pixels, counts);
}

}  // namespace kiloband::opencl
