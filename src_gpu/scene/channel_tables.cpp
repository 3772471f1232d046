#include "src_gpu/scene/channel_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <stdexcept>

#include "base/error.hpp"
#include "scene/compile/spectra/band_set.hpp"
#include "src_gpu/scene/channel_cover.hpp"
#include "src_gpu/scene/channel_lines.hpp"
#include "src_gpu/scene/channel_row.hpp"
#include "src_gpu/scene/channel_row_sources.hpp"

namespace kiloband::opencl {
namespace {

/// Where no number of cells attains the wanted error, ten times that is good enough.
constexpr double kAcceptedFactor = 10;
/// Rows whose ramps move the mean of a channel by more than this keep their knots: what half a cell of 4096 is of a channel, as where data end.
constexpr double kMeanError = 0.5 / 4096;

uint32_t padded(std::size_t n) {
  return static_cast<uint32_t>((n + 15) / 16 * 16);
}

/// Collects rows, then makes their nodes.
class TableMaker {
 public:
  TableMaker(const FlatScene& scene, const DerivedChannels& derived, const ChannelTableOptions& options)
      : scene_(scene), derived_(derived), options_(options) {
    for (std::size_t k = 0; k < scene.channels.size(); ++k)
      emission_factor_.push_back(scene.channels[k].width_nm() / scene.channel_scale[k]);
  }

  ChannelTables make();

 private:
  struct Row {
    RowFunction function;
    RowUnits units;
    double precision = 1;  // the error bound is divided by it
    /// By channel, at mu 0 and 1; if not empty, nothing else counts.
    std::vector<std::pair<double, double>> ends = {};
    const ChannelKnots* lines = nullptr;  // a gas's: then there is no function; or made of the function
    bool may_have_lines = false;          // read by evaluation alone
  };

  void add_spectra();
  void add_unit_rows();
  void add_planck_rows();
  void add_materials();
  void add_conductor(const KbMaterial& material);
  void add_dispersive(const KbMaterial& material);
  void add_band_sets();
  void add_derived();
  const SpectrumRow& spectrum(uint32_t row) const;
  std::vector<RowCells> choose() const;
  void fit(std::vector<RowCells>& cells) const;
  void keep_lines(std::vector<RowCells>& cells);
  void fill(const std::vector<RowCells>& cells);

  const FlatScene& scene_;
  const DerivedChannels& derived_;
  const ChannelTableOptions& options_;
  std::vector<double> emission_factor_;
  std::vector<Row> rows_;
  std::deque<ChannelKnots> lines_;  // of rows that keep theirs
  ChannelTables out_;
};

const SpectrumRow& TableMaker::spectrum(uint32_t row) const {
  if (row >= scene_.spectra.size())
    throw std::logic_error("channel tables: a material refers to no spectrum");
  return scene_.spectra[row];
}

void TableMaker::add_spectra() {
  for (const SpectrumRow& row : scene_.spectra) {
    if (row.absorption) {
      rows_.emplace_back().lines = row.absorption.get();
      continue;
    }
    rows_.push_back({spectrum_row(row), {row.is_emission ? emission_factor_ : std::vector<double>(), {}}});
    rows_.back().may_have_lines = true;
  }
  for (const KbTexture& texture : scene_.textures)
    if (texture.illuminant_row != KB_NONE) rows_.at(texture.illuminant_row).units.factor = emission_factor_;
}

void TableMaker::add_unit_rows() {
  out_.layout.unit_row = static_cast<uint32_t>(rows_.size());
  RowFunction one;
  one.value = [](double) { return 1.0; };
  rows_.push_back({one, {emission_factor_, {}}});
  out_.layout.wavelength_row = static_cast<uint32_t>(rows_.size());
  rows_.push_back({wavelength_row(), {}});
  out_.layout.lambda_row = KB_NONE;
  if (!scene_.features.plume) return;
  out_.layout.lambda_row = static_cast<uint32_t>(rows_.size());
  RowFunction lambda;
  lambda.value = [](double lambda_nm) { return lambda_nm; };
  rows_.push_back({lambda, {}});
}

void TableMaker::add_planck_rows() {
  out_.layout.planck_row = KB_NONE;
  if (!scene_.features.temperature_field) return;
  out_.layout.planck_row = static_cast<uint32_t>(rows_.size());
  std::vector<Row> rows(KB_PLANCK_ROWS);
  for (std::size_t k = 0; k < scene_.channels.size(); ++k) {
    const Channel& c = scene_.channels[k];
    const double high = static_cast<float>(c.min_nm), scale = std::log2(scene_.channel_scale[k]);
    rows[KB_PLANCK_MIN_HIGH].ends.push_back({high, high});
    rows[KB_PLANCK_MIN_LOW].ends.push_back({c.min_nm - high, c.min_nm - high});
    rows[KB_PLANCK_WIDTH].ends.push_back({c.width_nm(), c.width_nm()});
    rows[KB_PLANCK_MU].ends.push_back({0, 1});
    rows[KB_PLANCK_LOG2_SCALE].ends.push_back({scale, scale});
  }
  rows_.insert(rows_.end(), rows.begin(), rows.end());
}

/// n - 1 and k.
void TableMaker::add_conductor(const KbMaterial& material) {
  RowFunction index = spectrum_row(spectrum(material.eta_row));
  index.value = [n = index.value](double lambda_nm) { return n(lambda_nm) - 1; };
  rows_.push_back({std::move(index), {}});
  rows_.push_back({spectrum_row(spectrum(material.k_row)), {}});
}

/// Interior over exterior index, minus 1: matched boundaries keep their digits.
void TableMaker::add_dispersive(const KbMaterial& material) {
  RowFunction relative = spectrum_row(spectrum(material.eta_row));
  const auto interior = relative.value;
  if (material.ext_row == KB_NONE) {
    const double exterior = material.eta_ext;
    relative.value = [interior, exterior](double x) { return (interior(x) - exterior) / exterior; };
  } else {
    const RowFunction outside = spectrum_row(spectrum(material.ext_row));
    relative.merge(outside);
    relative.curved = true;
    relative.value = [interior, exterior = outside.value](double x) {
      return (interior(x) - exterior(x)) / exterior(x);
    };
  }
  rows_.push_back({std::move(relative), {}});
}

void TableMaker::add_materials() {
  for (const KbMaterial& material : scene_.materials) {
    const bool metal = material.type == KB_MATERIAL_CONDUCTOR || material.type == KB_MATERIAL_ROUGH_CONDUCTOR;
    const bool mirror = material.flags & KB_MATERIAL_PERFECT_MIRROR;
    const bool dispersive = !metal && (material.flags & KB_MATERIAL_DISPERSIVE);
    out_.material_rows.push_back((metal && !mirror) || dispersive ? static_cast<uint32_t>(rows_.size())
                                                                  : KB_NONE);
    if (metal && !mirror) add_conductor(material);
    if (dispersive) add_dispersive(material);
  }
}

/// The number of a channel's first band, the distance from there, and the unit of values. A position's error
/// counts in bands, whatever the position.
void TableMaker::add_band_sets() {
  out_.layout.band_row = static_cast<uint32_t>(rows_.size());
  for (const BandSet& set : scene_.band_sets) {
    std::vector<double> first;
    for (const Channel& channel : scene_.channels) first.push_back(band_position(set, channel.min_nm).index);
    RowFunction one;
    one.value = [](double) { return 1.0; };
    rows_.push_back({std::move(one), {first, {}}});
    rows_.push_back({band_position_row(set), {{}, first}, static_cast<double>(set.centres_nm.size())});
    RowFunction unit;
    unit.value = [&set](double lambda_nm) { return band_position(set, lambda_nm).inside ? set.scale : 0.0; };
    if (!set.extrapolate) unit.jumps_nm = {set.min_nm, set.max_nm};
    rows_.push_back({std::move(unit), {set.is_emission ? emission_factor_ : std::vector<double>(), {}}});
    rows_.back().may_have_lines = true;
  }
}

/// Responses in the unit of the brightest channel that they meet.
void TableMaker::add_derived() {
  out_.layout.derived_row = static_cast<uint32_t>(rows_.size());
  for (const RegularTable& response : derived_.responses) {
    const Spectrum::Range range = response.support();
    std::vector<double> factor(scene_.channels.size(), 0.0);
    double scale = 0;
    for (std::size_t k = 0; k < factor.size(); ++k) {
      const Channel& c = scene_.channels[k];
      if (c.max_nm < range.min_nm || c.min_nm > range.max_nm) continue;
      factor[k] = scene_.channel_scale[k];
      scale = std::max(scale, factor[k]);
    }
    if (scale == 0) scale = 1;
    for (double& f : factor) f /= scale;
    out_.derived_scale.push_back(scale);
    rows_.push_back({RowFunction::of_table(response), {std::move(factor), {}}});
    rows_.back().may_have_lines = true;
  }
}

std::vector<RowCells> TableMaker::choose() const {
  std::vector<RowCells> cells;
  for (const Row& row : rows_) {
    if (row.lines) {
      cells.push_back({0, 0, false});
      continue;
    }
    if (!row.ends.empty()) {
      cells.push_back({});
      continue;
    }
    const double wanted = options_.relative_error / row.precision;
    cells.push_back(
        choose_cells(row.function, scene_.channels, wanted, kAcceptedFactor * wanted, options_.max_cells));
  }
  return cells;
}

/// Halves the largest rows until all fit.
void TableMaker::fit(std::vector<RowCells>& cells) const {
  const std::size_t node_bytes = padded(scene_.channels.size()) * sizeof(float);
  const auto bytes = [&] {
    std::size_t nodes = 0;
    for (const RowCells& row : cells) nodes += row.cells + 1;
    return nodes * node_bytes;
  };
  while (bytes() > options_.max_bytes) {
    const auto largest = std::ranges::max_element(cells, {}, &RowCells::cells);
    if (largest->cells <= 1) return;
    largest->cells /= 2;
    const auto row = static_cast<std::size_t>(largest - cells.begin());
    largest->error = error_of_cells(rows_[row].function, scene_.channels, largest->cells);
  }
}

/// Emission narrower than a cell would be lost, or be as wide as one.
/// throws InputError  their points, of each channel its own, take more than max_line_bytes
void TableMaker::keep_lines(std::vector<RowCells>& cells) {
  std::size_t bytes = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    const bool attained = cells[r].error <= kAcceptedFactor * options_.relative_error && !cells[r].has_jump;
    if (!row.may_have_lines || row.lines || attained) continue;
    if (mean_error_of_cells(row.function, scene_.channels, cells[r].cells) <= kMeanError) continue;
    lines_.push_back(knots_of(row.function, scene_.channels, row.units));
    row.lines = &lines_.back();
    bytes += line_floats(lines_.back()) * sizeof(float);
    if (bytes > options_.max_line_bytes)
      throw InputError(fmt::format(
          "channels: the points of spectra with lines that are narrow for the channels take more than {} bytes in {} channels: "
          "render fewer at a time, or on the CPU",
          options_.max_line_bytes, scene_.channels.size()));
    cells[r] = {0, 0, false};
    out_.has_lines = true;
  }
}

void TableMaker::fill(const std::vector<RowCells>& cells) {
  const std::size_t stride = out_.layout.stride;
  std::size_t size = 0;
  for (const RowCells& row : cells) {
    out_.tables.push_back({static_cast<uint32_t>(size), row.cells});
    out_.error.push_back(row.error);
    out_.has_jump.push_back(row.has_jump);
    const ChannelKnots* lines = rows_[out_.tables.size() - 1].lines;
    size += lines ? line_floats(*lines) : (std::size_t{row.cells} + 1) * stride;
    if (size > std::numeric_limits<uint32_t>::max())
      throw std::logic_error("channel tables: more nodes than 32 bits count");
  }
  out_.nodes.assign(size, 0.0f);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    float* nodes = out_.nodes.data() + out_.tables[r].first;
    if (rows_[r].lines) {
      fill_lines(*rows_[r].lines, nodes);
      continue;
    }
    for (std::size_t k = 0; k < rows_[r].ends.size(); ++k) {
      nodes[k] = static_cast<float>(rows_[r].ends[k].first);
      nodes[stride + k] = static_cast<float>(rows_[r].ends[k].second);
    }
    if (!rows_[r].ends.empty()) continue;
    fill_nodes(rows_[r].function, scene_.channels, rows_[r].units, cells[r].cells, stride, nodes);
  }
}

ChannelTables TableMaker::make() {
  KbSpectraLayout& layout = out_.layout;
  layout.channels = static_cast<uint32_t>(scene_.channels.size());
  layout.stride = padded(scene_.channels.size());
  layout.derived = static_cast<uint32_t>(derived_.responses.size());
  layout.film_width = scene_.camera.film_width;
  layout.film_columns = layout.stride + padded(derived_.responses.size());
  add_spectra();
  add_unit_rows();
  add_planck_rows();
  add_materials();
  add_band_sets();
  add_derived();
  layout.rows = static_cast<uint32_t>(rows_.size());
  std::vector<RowCells> cells = choose();
  fit(cells);
  keep_lines(cells);
  fill(cells);
  if (layout.derived > 0) {
    ChannelCover cover = make_channel_cover(scene_.channels, options_.max_bytes);
    layout.overlapping = cover.overlapping ? 1 : 0;
    out_.cover = std::move(cover.cover);
    out_.cover_breaks = std::move(cover.breaks);
  }
  return std::move(out_);
}

}  // namespace

ChannelTables make_channel_tables(const FlatScene& scene, const DerivedChannels& derived,
                                  const ChannelTableOptions& options) {
  if (scene.channel_scale.size() != scene.channels.size())
    throw std::logic_error("channel tables: channel_scale has not K entries");
  return TableMaker(scene, derived, options).make();
}

}  // namespace kiloband::opencl
