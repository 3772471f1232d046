// Cubes from cubes: selection, re-binning, cropping, change of quantity and format;
// tables of pixels and regions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "cube/cube_io.hpp"
#include "film/spectral_film.hpp"
#include "post/replicated_cube.hpp"

namespace kiloband {

struct WavelengthRange {
  double min_nm = 0, max_nm = 0;
};

/// What is wanted of a cube; the steps apply in this order.
struct CubeSelection {
  ChannelList wavelengths;               // for bands that have names only; empty: none are given
  std::vector<std::size_t> bands;        // indices from 0 in the wanted order; empty: all
  std::optional<WavelengthRange> range;  // bands that lie inside as a whole; derived bands are dropped
  std::optional<ChannelList>
      rebin;                      // coarser channels, each a union of whole bands; derived bands are dropped
  std::optional<PixelRect> crop;  // x0, y0 from the upper left corner
  std::optional<Quantity> quantity;  // of the result; the source's if not given
};

/// "0-9,20,5": indices from 0 in the order given.
/// throws InputError  not such a list, an index >= count, an index given twice
std::vector<std::size_t> parse_band_indices(std::string_view text, std::size_t count);

/// "red=600-700, green=500-600": wavelengths in nm for bands that have names only; entries are separated by
/// commas or line breaks, '#' begins a comment. The bands become ordinary ones, whose values are what the
/// cube's quantity says, and stand first, in this order.
/// throws InputError  not such a list, a name given twice
ChannelList parse_band_wavelengths(std::string_view text);

/// throws InputError  the region is empty or not inside the image
void check_region(const CubeInfo& info, const PixelRect& region);

/// The selected part of a cube as a cube that is read like any other; nothing is read before its rows are
/// asked for. A sum of bands has no standard error of its own (bands share paths, so their errors are
/// correlated): its variance is NaN, and without any channel that is a single band there is no variance at
/// all. A note says so.
/// throws InputError  empty selection, a crop outside the image, a coarse channel that is no union of bands
std::unique_ptr<CubeReader> select_from_cube(std::unique_ptr<CubeReader> source,
                                             const CubeSelection& selection, const DiagnosticSink& sink = {});
/// The same part of a cube and of its replicates: sums of bands have error bars if there are replicates.
ReplicatedCube select_from_cube(ReplicatedCube source, const CubeSelection& selection,
                                const DiagnosticSink& sink = {});

/// Copies a cube to a file by extension, a strip of rows at a time (about 128 MiB, at least 32 rows). Values
/// keep their bits where the quantity does not change. Values that are infinite, in the source or for
/// float32, are a warning.
void write_cube(CubeReader& source, const std::filesystem::path& out, Quantity quantity_on_disk,
                const DiagnosticSink& sink = {});

/// Opens a cube with its replicates if there are any, select_from_cube, write_cube. Without
/// selection.quantity, EXR gets densities and ENVI what the source holds.
/// Sums of channels have the variance that the replicates give.
void convert_cube(const std::filesystem::path& in, const std::filesystem::path& out,
                  const CubeSelection& selection, const DiagnosticSink& sink = {});

/// CSV with the columns channel,min_nm,max_nm,value[,standard_error], one row per band, in the cube's
/// quantity. A place of one pixel has a standard error if the cube has variances. A larger one is the mean of
/// its pixels without NaN (a note says how many have one) and has none: the errors of pixels are correlated and must not be pooled. With
/// several places each row begins with x,y,width,height. Infinite values and errors are a warning.
/// throws InputError  no place, an empty place or one outside the image
void write_csv(CubeReader& source, const std::filesystem::path& out, const std::vector<PixelRect>& places,
               const DiagnosticSink& sink = {});
/// The same with a standard error for every place, from the replicates if there are any: of a region from those that have values in all
/// its pixels; a note says if these are not all.
void write_csv(ReplicatedCube& source, const std::filesystem::path& out, const std::vector<PixelRect>& places,
               const DiagnosticSink& sink = {});

}  // namespace kiloband
