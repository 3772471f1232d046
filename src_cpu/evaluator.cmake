# Deferred evaluation of saved paths, SIMD over channels.
kiloband_library(kiloband_cpu_evaluator
  SOURCES dense_spectra.cpp derived_rows.cpp evaluate_reference.cpp evaluator.cpp evaluator_kernels.cpp
          evaluator_program.cpp isa.cpp spectral_textures.cpp
  DEPENDS kiloband_base kiloband_spectral kiloband_flatten PkgConfig::HWY)
