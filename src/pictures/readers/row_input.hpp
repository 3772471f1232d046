// What picture readers have in common: exceptions become error(), and files that are decoded from the top row by row can be
// read anywhere.
#pragma once

#include <algorithm>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "pictures/picture_library.hpp"

namespace kiloband {

/// read_rows() throws what is wrong.
class GuardedInput : public PictureInput {
 public:
  const Spec& spec() const override { return spec_; }
  std::string error() override { return error_; }

  bool read(int begin, int end, int first, int count, float* target) override {
    try {
      read_rows(begin, end, first, count, target);
      return true;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& reason) {
      error_ = reason.what();
      return false;
    }
  }

 protected:
  virtual void read_rows(int begin, int end, int first, int count, float* target) = 0;

  Spec spec_;

 private:
  std::string error_;
};

/// A decoder that has delivered the rows above.
class RowDecoder {
 public:
  virtual ~RowDecoder() = default;
  virtual const PictureInput::Spec& spec() const = 0;
  /// The next row, [x][channel].
  virtual void next_row(float* target) = 0;
};

/// Rows in any order: the decoder starts again where one above is asked for.
class RowInput : public GuardedInput {
 public:
  using Start = std::function<std::unique_ptr<RowDecoder>()>;

  RowInput(std::unique_ptr<RowDecoder> decoder, Start start)
      : decoder_(std::move(decoder)), start_(std::move(start)) {
    spec_ = decoder_->spec();
  }

 protected:
  void read_rows(int begin, int end, int first, int count, float* target) override {
    if (begin < next_) {
      decoder_ = start_();
      next_ = 0;
    }
    const std::size_t channels = spec_.channels.size(), width = static_cast<std::size_t>(spec_.width);
    row_.resize(width * channels);
    while (next_ < end) {
      const bool whole = next_ >= begin && static_cast<std::size_t>(count) == channels;
      decoder_->next_row(whole ? target : row_.data());
      if (next_++ < begin) continue;
      if (!whole)
        for (std::size_t x = 0; x < width; ++x)
          std::copy_n(&row_[x * channels + first], count, target + x * count);
      target += width * count;
    }
  }

 private:
  std::unique_ptr<RowDecoder> decoder_;
  Start start_;
  std::vector<float> row_;
  int next_ = 0;
};

/// A picture that Decoder(file) reads; its own null() says that it leaves the file to others.
template <class Decoder>
std::unique_ptr<PictureInput> open_rows(const std::string& file) {
  auto decoder = std::make_unique<Decoder>(file);
  if (!decoder->reads_it()) return nullptr;
  return std::make_unique<RowInput>(std::move(decoder), [file] { return std::make_unique<Decoder>(file); });
}

/// Y; Y, A; R, G, B; R, G, B, A.
void name_channels(PictureInput::Spec& spec, int count);

}  // namespace kiloband
