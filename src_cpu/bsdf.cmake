kiloband_library(kiloband_cpu_bsdf
  SOURCES bsdf_conductor.cpp bsdf_dielectric.cpp bsdf_dispatch.cpp bsdf_plastic.cpp bsdf_rough_transmittance.cpp
          microfacet.cpp spectral_mis.cpp
  DEPENDS kiloband_base glm::glm)
kiloband_hot(kiloband_cpu_bsdf)
