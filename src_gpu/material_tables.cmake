kiloband_library(kiloband_gpu_tables
  SOURCES material_tables.cpp rough_transmittance.cpp
  DEPENDS kiloband_flatten kiloband_base)
