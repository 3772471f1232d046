# The backend itself: pool, evaluation, rounds.
kiloband_library(kiloband_gpu
  SOURCES device_scene.cpp device_state.cpp evaluation.cpp film_delivery.cpp group_renderer.cpp launch_pace.cpp opencl_backend.cpp
          path_memory.cpp path_pool.cpp round_plan.cpp trace_paths.cpp
  DEPENDS kiloband_base kiloband_backend kiloband_film kiloband_filter kiloband_flatten kiloband_opencl kiloband_gpu_bvh kiloband_gpu_tables
          kiloband_gpu_spectra fmt::fmt)
