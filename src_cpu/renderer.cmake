kiloband_library(kiloband_cpu
  SOURCES block_worker.cpp channel_choice.cpp conductor_bound.cpp cpu_backend.cpp embree_scene.cpp path_tracer.cpp path_tracer_dispersion.cpp path_tracer_gas.cpp path_tracer_shade.cpp path_tracer_thermal.cpp
  DEPENDS kiloband_base kiloband_backend kiloband_film kiloband_cpu_bsdf kiloband_cpu_lights kiloband_cpu_evaluator kiloband_flatten
          embree OpenMP::OpenMP_CXX glm::glm fmt::fmt)
kiloband_hot(kiloband_cpu)
