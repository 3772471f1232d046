# Host layer: devices, memory, errors, programs and kernels.
# The kernels' text goes into the binary. All of kernels/ and src/shared is taken, so that a new file cannot be
# forgotten; editing one embeds again.
file(GLOB kernel_files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
     ${PROJECT_SOURCE_DIR}/kernels/*.cl ${PROJECT_SOURCE_DIR}/kernels/*.clh ${PROJECT_SOURCE_DIR}/src/shared/*.h)
list(TRANSFORM kernel_files PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE kernel_paths)
list(JOIN kernel_files "|" kernel_list)
set(embedded_kernels ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
add_custom_command(
  OUTPUT ${embedded_kernels}
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DOUTPUT=${embedded_kernels} "-DFILES=${kernel_list}"
          -P ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.cmake
  DEPENDS ${kernel_paths} ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.cmake
  COMMENT "Embedding the kernels"
  VERBATIM)

kiloband_library(kiloband_opencl
  SOURCES context.cpp device.cpp errors.cpp kernel.cpp kernel_sources.cpp memory.cpp
          neutral_folder.cpp pocl_cache.cpp program.cpp program_cache.cpp
          ${embedded_kernels}
  DEPENDS kiloband_base kiloband_film OpenCL::OpenCL OpenCL::HeadersCpp)
