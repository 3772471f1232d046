// A backend that passes everything on to another, for those that change a single call.
#pragma once

#include <memory>
#include <utility>

#include "render/backend.hpp"

namespace kiloband::test {

class WrappedBackend : public Backend {
 public:
  explicit WrappedBackend(std::unique_ptr<Backend> backend) : backend_(std::move(backend)) {}

  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override {
    backend_->render(film, range, blocks, stop, progress);
  }
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override { return backend_->auxiliary(rect); }
  std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange& range) override {
    return backend_->trace(rect, range);
  }
  void camera_moved() override { backend_->camera_moved(); }
  BackendInfo info() const override { return backend_->info(); }
  BackendStatistics statistics() const override { return backend_->statistics(); }
  std::vector<double> film_scale() const override { return backend_->film_scale(); }
  SumRule sum_rule() const override { return backend_->sum_rule(); }
  uint32_t blocks_at_once(uint32_t samples) const override { return backend_->blocks_at_once(samples); }

 private:
  std::unique_ptr<Backend> backend_;
};

}  // namespace kiloband::test
