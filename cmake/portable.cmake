# `cmake --build build/release --target portable`: kiloband-portable.tar.gz in the build folder (docs/portable.md).
if(KILOBAND_NATIVE OR KILOBAND_SANITIZE)
  return()
endif()

# The program once more, which finds ../lib: with DT_RPATH, which the libraries' own libraries are looked for by, too.
add_executable(kiloband_portable EXCLUDE_FROM_ALL $<TARGET_OBJECTS:kiloband>)
get_target_property(_libraries kiloband LINK_LIBRARIES)
target_link_libraries(kiloband_portable PRIVATE ${_libraries})
target_link_options(kiloband_portable PRIVATE -Wl,--disable-new-dtags)
set_target_properties(kiloband_portable PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "$ORIGIN/../lib")

set(_tests "")
if(KILOBAND_TESTS)
  set(_tests test_gpu_lights test_gpu_bsdf test_gpu_bvh)
endif()
set(_test_files "")
foreach(_test IN LISTS _tests)
  list(APPEND _test_files $<TARGET_FILE:${_test}>)
endforeach()
set(KILOBAND_PACK ${PROJECT_SOURCE_DIR}/scripts/portable/pack.sh)
add_custom_target(portable
  COMMAND ${KILOBAND_PACK} ${PROJECT_BINARY_DIR}/kiloband-portable $<TARGET_FILE:kiloband_portable> ${_test_files}
  COMMAND ${CMAKE_COMMAND} -E tar czf kiloband-portable.tar.gz kiloband-portable
  COMMAND ${PROJECT_SOURCE_DIR}/scripts/portable/check_size.sh kiloband-portable.tar.gz
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR}
  DEPENDS kiloband_portable ${_tests} VERBATIM)
