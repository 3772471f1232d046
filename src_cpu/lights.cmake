# Cameras, lights, texture addressing and the geometry of analytic shapes.
kiloband_library(kiloband_cpu_lights
  SOURCES camera.cpp texture_lookup.cpp shape_geometry.cpp surface_hit.cpp emitter.cpp emitter_area.cpp
          emitter_environment.cpp thermal.cpp
  DEPENDS kiloband_base kiloband_filter glm::glm)
kiloband_hot(kiloband_cpu_lights)
