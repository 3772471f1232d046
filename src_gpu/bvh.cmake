# The acceleration structure, built with Embree's builder.
kiloband_library(kiloband_gpu_bvh
  SOURCES bvh_builder.cpp bvh_primitives.cpp
  DEPENDS kiloband_flatten kiloband_base embree fmt::fmt)
