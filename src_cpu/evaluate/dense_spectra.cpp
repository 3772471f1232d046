#include "src_cpu/evaluate/dense_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "shared/records.h"
#include "spectral/planck.hpp"

namespace kiloband::cpu {
namespace {

/// Stores x as the sum of two floats: 48 bits, so that differences of rows keep float precision.
void split(double x, float& high, float& low) {
  high = static_cast<float>(x);
  low = static_cast<float>(x - high);
}

/// What a Planck row multiplies Planck's law by.
double planck_factor(const SpectrumRow& row, double lambda_nm) {
  if (lambda_nm < row.planck_min_nm || lambda_nm > row.planck_max_nm) return 0;
  return row.planck_scale * (row.table.values.empty() ? 1 : row.table(lambda_nm));
}

/// Whether metal_fresnel() has the reflectance of index n + ik at any angle to some units in the last place: R >= 1/4 (it is least, in
/// R_s, at normal incidence), |(n + ik)^2 - s^2| >= 1/2 for all sines, and no product of its terms leaves the range of floats.
bool is_metallic(double n, double k) {
  const double square = n * n + k * k, real = n * n - k * k;  // of (n + ik)^2
  if (square + 1 - 2 * n < 0.25 * (square + 1 + 2 * n) || square > 1e8) return false;
  const double nearest = real - std::clamp(real, 0.0, 1.0);
  return nearest * nearest + 4 * n * n * k * k >= 0.25;
}

}  // namespace

DenseSpectra::DenseSpectra(const FlatScene& scene, const EvaluatorKernels& kernels)
    : scene_(scene),
      kernels_(kernels),
      channels_(scene.channels.size()),
      padded_(pad_channels(channels_)),
      lambda_(aligned_zeros<double>(padded_)),
      texture_offsets_(aligned_zeros<float>(padded_)),
      colour_cells_(scene.channels, padded_),
      unit_emission_(aligned_zeros<float>(padded_)),
      rows_(scene.spectra.size()),
      material_rows_(scene.materials.size()),
      float_tables_(scene.spectra.size()),
      pool_(channels_) {
  if (scene.channel_scale.size() != channels_)
    throw std::logic_error("dense spectra: channel_scale has not K entries");
  for (std::size_t k = 0; k < channels_; ++k) {
    min_nm_.push_back(scene.channels[k].min_nm);
    max_nm_.push_back(scene.channels[k].max_nm);
    emission_factor_.push_back(scene.channels[k].width_nm() / scene.channel_scale[k]);
    unit_emission_[k] = static_cast<float>(emission_factor_[k]);
  }
  emission_factor_.resize(padded_);
  for (const SpectrumRow& row : scene.spectra) is_emission_.push_back(row.is_emission);
  for (const KbTexture& texture : scene.textures) {
    if (texture.illuminant_row != KB_NONE) is_emission_.at(texture.illuminant_row) = true;
  }
}

void DenseSpectra::begin(double mu, bool fast) {
  mu_ = mu;
  fast_ = fast;
  ++generation_;
  pool_.release();
  for (std::size_t k = 0; k < channels_; ++k) lambda_[k] = (1 - mu) * min_nm_[k] + mu * max_nm_[k];
}

void DenseSpectra::throw_bad_row(uint32_t s) {
  throw std::logic_error("saved path: spectrum " + std::to_string(s) + " does not exist");
}

ColourOffsets DenseSpectra::texture_offsets() {
  if (texture_generation_ != generation_) {
    float* const offsets = texture_offsets_.get();
    for (std::size_t k = 0; k < channels_; ++k)
      offsets[k] = static_cast<float>(std::clamp(lambda_[k], 360.0, 830.0) - KB_TEXTURE_CENTRE_NM);
    if (channels_ > 0) std::fill(offsets + channels_, offsets + padded_, offsets[channels_ - 1]);
    placed_cells_ = fast_ ? nullptr : colour_cells_.place(offsets);
    const auto as_the_last = [&](std::size_t k) {
      return offsets[k] == offsets[channels_ - 1] &&
             (!placed_cells_ || placed_cells_->cell[k] == placed_cells_->cell[channels_ - 1]);
    };
    distinct_offsets_ = channels_;
    while (distinct_offsets_ > 0 && as_the_last(distinct_offsets_ - 1)) --distinct_offsets_;
    texture_generation_ = generation_;
  }
  return {texture_offsets_.get(), distinct_offsets_, placed_cells_};
}

const float* DenseSpectra::planck_second() {
  if (!planck_second_) planck_second_ = aligned_zeros<float>(padded_);
  if (planck_second_generation_ != generation_) {
    std::fill_n(planck_second_.get(), padded_,
                1e6f);  // as short waves have it: long ones take longer
    for (std::size_t k = 0; k < channels_; ++k)
      planck_second_[k] = static_cast<float>(kPlanckSecond_nm_k / lambda_[k]);
    planck_second_generation_ = generation_;
  }
  return planck_second_.get();
}

const float* DenseSpectra::make_spectrum(uint32_t s) {
  float* out = pool_.take();
  const SpectrumRow& row = scene_.spectra[s];
  if (row.absorption) {
    for (std::size_t k = 0; k < channels_; ++k) out[k] = static_cast<float>((*row.absorption)(k, mu_));
  } else if (fast_ && !row.is_planck && !is_emission_[s]) {
    kernels_.sample_table(view_of(float_table(s), row.table), lambda_.get(), channels_, out);
    std::fill(out + channels_, out + padded_, 0.0f);
  } else {
    fill_exact(s, out);
  }
  rows_[s] = {generation_, out};
  return out;
}

const std::vector<double>& DenseSpectra::planck(double temperature_k) {
  PlanckRow& row = planck_[temperature_k];
  if (row.generation == generation_) return row.radiance;
  row.generation = generation_;
  row.radiance.resize(channels_);
  for (std::size_t k = 0; k < channels_; ++k)
    row.radiance[k] = planck_radiance(lambda_[k], temperature_k) * emission_factor_[k];
  return row.radiance;
}

void DenseSpectra::fill_planck(double temperature_k, const float* emissivity, float* out) {
  if (planck_generation_ != generation_) {
    planck_a_.resize(channels_);
    planck_b_.resize(channels_);
    for (std::size_t k = 0; k < channels_; ++k) {
      const PlanckTerms terms = planck_terms(lambda_[k]);
      planck_a_[k] = terms.a * emission_factor_[k];
      planck_b_[k] = terms.b;
    }
    planck_generation_ = generation_;
  }
  std::fill(out, out + padded_, 0.0f);
  if (!(temperature_k > 0)) return;
  const double inverse = 1 / temperature_k;
  for (std::size_t k = 0; k < channels_; ++k) {
    const double e = std::exp(-planck_b_[k] * inverse);
    out[k] = static_cast<float>(planck_a_[k] * e / (1 - e));
  }
  if (!emissivity) return;
  for (std::size_t k = 0; k < channels_; ++k) out[k] *= emissivity[k];
}

void DenseSpectra::fill_exact(uint32_t s, float* out) {
  const SpectrumRow& row = scene_.spectra[s];
  if (!row.is_planck) {
    kernels_.sample_exact(view_of(row.table.values, row.table), lambda_.get(),
                          is_emission_[s] ? emission_factor_.data() : nullptr, channels_, out);
    std::fill(out + channels_, out + padded_, 0.0f);
    return;
  }
  const double* const film = is_emission_[s] ? planck(row.temperature_k).data() : nullptr;
  for (std::size_t k = 0; k < channels_; ++k) {
    const double radiance = film ? film[k] : planck_radiance(lambda_[k], row.temperature_k);
    out[k] = static_cast<float>(planck_factor(row, lambda_[k]) * radiance);
  }
}

const std::vector<float>& DenseSpectra::float_table(uint32_t s) {
  std::vector<float>& table = float_tables_[s];
  if (table.empty()) {
    const std::vector<double>& values = scene_.spectra[s].table.values;
    table.assign(values.begin(), values.end());
  }
  return table;
}

const double* DenseSpectra::exact_values(uint32_t s, std::vector<double>& out) const {
  const SpectrumRow& row = scene_.spectra[s];
  out.resize(padded_);
  if (row.is_planck) {
    for (std::size_t k = 0; k < channels_; ++k)
      out[k] = planck_factor(row, lambda_[k]) * planck_radiance(lambda_[k], row.temperature_k);
  } else {
    kernels_.sample_double(view_of(row.table.values, row.table), lambda_.get(), channels_, out.data());
  }
  return out.data();
}

DenseSpectra::MaterialRows& DenseSpectra::material_rows(uint32_t material) {
  if (material >= material_rows_.size()) throw std::logic_error("saved path: material does not exist");
  const KbMaterial& record = scene_.materials[material];
  if (record.eta_row >= rows_.size()) throw_bad_row(record.eta_row);
  return material_rows_[material];
}

std::array<const float*, 3> DenseSpectra::conductor(uint32_t material) {
  MaterialRows& rows = material_rows(material);
  if (rows.generation[0] != generation_) {
    const KbMaterial& record = scene_.materials[material];
    if (record.k_row >= rows_.size()) throw_bad_row(record.k_row);
    rows.data[0] = {pool_.take(), pool_.take(), pool_.take(), nullptr};
    const double* const indices = exact_values(record.eta_row, optical_[0]);
    const double* const absorptions = exact_values(record.k_row, optical_[1]);
    for (std::size_t k = 0; k < channels_; ++k) {
      const double n = indices[k], absorption = absorptions[k];
      split((n - 1) * (n + 1) - absorption * absorption, rows.data[0][0][k], rows.data[0][1][k]);
      // Rows of one path alone would not earn what the question costs.
      const bool metal = !fast_ && is_metallic(n, absorption);
      rows.data[0][2][k] = static_cast<float>(metal ? n * absorption : -n * absorption);
    }
    rows.generation[0] = generation_;
  }
  return {rows.data[0][0], rows.data[0][1], rows.data[0][2]};
}

std::array<const float*, 4> DenseSpectra::dispersive(uint32_t material, bool inside) {
  MaterialRows& rows = material_rows(material);
  if (rows.generation[inside] != generation_) {
    const KbMaterial& record = scene_.materials[material];
    if (record.ext_row != KB_NONE && record.ext_row >= rows_.size()) throw_bad_row(record.ext_row);
    rows.data[inside] = {pool_.take(), pool_.take(), pool_.take(), pool_.take()};
    const double* const interiors = exact_values(record.eta_row, optical_[0]);
    const double* const exteriors =
        record.ext_row == KB_NONE ? nullptr : exact_values(record.ext_row, optical_[1]);
    for (std::size_t k = 0; k < channels_; ++k) {
      const double interior = interiors[k], exterior = exteriors ? exteriors[k] : record.eta_ext;
      const double e = inside ? exterior / interior : interior / exterior;
      const double big_e = (e - 1) * (e + 1);
      split(big_e, rows.data[inside][0][k], rows.data[inside][1][k]);
      rows.data[inside][2][k] = static_cast<float>(e - 1);
      rows.data[inside][3][k] = static_cast<float>(e / std::max(big_e * big_e, 1e-30));
    }
    rows.generation[inside] = generation_;
  }
  return {rows.data[inside][0], rows.data[inside][1], rows.data[inside][2], rows.data[inside][3]};
}

}  // namespace kiloband::cpu
