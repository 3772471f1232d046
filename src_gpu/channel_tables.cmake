# Spectra for devices.
kiloband_library(kiloband_gpu_spectra
  SOURCES channel_tables.cpp channel_row.cpp channel_row_sources.cpp channel_cover.cpp channel_lines.cpp
  DEPENDS kiloband_base kiloband_spectral kiloband_flatten fmt::fmt)
