kiloband_library(kiloband_flatten
  SOURCES camera_media.cpp flatten.cpp flatten_camera.cpp flatten_emitters.cpp flatten_materials.cpp flatten_media.cpp flatten_shapes.cpp
          flatten_textures.cpp lattice_cdf.cpp spectrum_table_builder.cpp envmap_sampling.cpp
  DEPENDS kiloband_base kiloband_spectral glm::glm fmt::fmt)
