kiloband_library(kiloband_flatten
  SOURCES camera_media.cpp flatten.cpp flatten_camera.cpp flatten_channel_bins.cpp flatten_emitters.cpp flatten_materials.cpp flatten_media.cpp flatten_place.cpp
          flatten_shapes.cpp
          flatten_spectral.cpp flatten_textures.cpp flatten_thermal.cpp flatten_temperature.cpp band_set.cpp lattice_cdf.cpp
          spectrum_table_builder.cpp envmap_sampling.cpp facet_quadrature.cpp compensation.cpp metal_emissivity.cpp
  DEPENDS kiloband_base kiloband_spectral kiloband_meshes glm::glm fmt::fmt)
