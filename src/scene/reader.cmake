kiloband_library(kiloband_reader
  SOURCES reader.cpp limits.cpp xml_document.cpp xml_values.cpp xml_grammar.cpp xml_substitute.cpp xml_tree.cpp xml_references.cpp
          read_object.cpp read_transform.cpp read_spectrum.cpp read_spectrum_object.cpp read_texture.cpp
          read_spectral_texture.cpp read_ior.cpp read_thermal.cpp
          read_bsdf.cpp read_emitter.cpp read_medium.cpp read_errors.cpp read_primitives.cpp read_shape.cpp read_film.cpp read_sensor.cpp
          read_integrator.cpp
  DEPENDS kiloband_base kiloband_spectral kiloband_meshes kiloband_images pugixml::pugixml glm::glm)
