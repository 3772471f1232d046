# One set of flags for every target: SSE4.2 baseline, no contraction (results are to agree between back ends).
# -Wrestrict is off: GCC 12 reports it for plain std::string concatenation (GCC bug 105651).
add_library(kiloband_flags INTERFACE)
# Initialisers may leave members out that are to be empty, except in targets with the property KILOBAND_ALL_MEMBERS.
target_compile_options(kiloband_flags INTERFACE -Wall -Wextra -Wshadow $<$<NOT:$<BOOL:$<TARGET_PROPERTY:KILOBAND_ALL_MEMBERS>>>:-Wno-missing-field-initializers> $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> -ffp-contract=off -msse4.2 -mpclmul -maes)
target_include_directories(kiloband_flags INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
if(KILOBAND_WERROR)
  target_compile_options(kiloband_flags INTERFACE -Werror)
endif()
if(KILOBAND_NATIVE)  # base/simd_targets.hpp
  target_compile_options(kiloband_flags INTERFACE -march=native)
  target_compile_definitions(kiloband_flags INTERFACE KILOBAND_NATIVE)
endif()
if(KILOBAND_SANITIZE)
  target_compile_options(kiloband_flags INTERFACE -fsanitize=${KILOBAND_SANITIZE} -fno-sanitize-recover=all
                                                  -fno-omit-frame-pointer)
  target_link_options(kiloband_flags INTERFACE -fsanitize=${KILOBAND_SANITIZE})
endif()
if(KILOBAND_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "KILOBAND_FUZZ needs clang: configure with the preset fuzz")
  endif()
  target_compile_options(kiloband_flags INTERFACE -fsanitize=fuzzer-no-link)  # counts which code an input reaches
endif()

set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")

# kiloband_precompiled(name DEPENDS ... HEADERS ...): headers that targets with the same flags read precompiled:
# target_precompile_headers(target REUSE_FROM name). Files include what they use all the same: clang-tidy reads them without.
function(kiloband_precompiled name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;HEADERS" ${ARGN})
  file(WRITE ${PROJECT_BINARY_DIR}/${name}.cpp "// Carries ${name}'s precompiled headers.\n")
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE kiloband_flags ${ARG_DEPENDS})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()
set(KILOBAND_STANDARD_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits> <map>
                              <memory> <numeric> <optional> <random> <set> <span> <sstream> <stdexcept> <string> <string_view> <utility> <vector>)
kiloband_precompiled(kiloband_headers HEADERS ${KILOBAND_STANDARD_HEADERS})

# kiloband_unity(name [files...]): with KILOBAND_UNITY, files are compiled sixteen at a time (names of anonymous namespaces must differ
# then; files of tests have a namespace each, so that no overload of one is another's). Files with options of their own, those that
# are compiled once per instruction set, and `files` stay alone.
function(kiloband_unity name)
  if(KILOBAND_UNITY)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
  endif()
endfunction()

# kiloband_library(name SOURCES ... DEPENDS ...): a static library with the project's flags.
function(kiloband_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC kiloband_flags ${ARG_DEPENDS})
  target_precompile_headers(${name} REUSE_FROM kiloband_headers)
  kiloband_unity(${name})
endfunction()

# kiloband_hot(name): a library whose loops are worth -O3. Everything else has -O2, which compiles a third faster.
function(kiloband_hot name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
endfunction()

# kiloband_test_options(name optimised): what compiles tests fast. -O0, which halves that time: their own code is not what takes it when they
# run, except where it computes what the project's does (`optimised`: -O1; there, GCC 12 reports bounds of strings that are put together,
# bugs 105329, 105651, which address sanitizer knows better). Precompiled headers go with one level.
function(kiloband_test_options name optimised)
  set(level 0)
  if(optimised)
    set(level 1)
  endif()
  if(NOT TARGET kiloband_test_headers_O${level})
    kiloband_precompiled(kiloband_test_headers_O${level} DEPENDS GTest::gtest HEADERS ${KILOBAND_STANDARD_HEADERS} <gtest/gtest.h>)
    target_compile_options(kiloband_test_headers_O${level} PRIVATE $<$<CONFIG:Release>:-O${level}>)
  endif()
  target_precompile_headers(${name} REUSE_FROM kiloband_test_headers_O${level})
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O${level}> "$<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow>")
endfunction()

# The longest that a test may take. Of a release build the longest need two minutes (tests/costs/costs.cmake), on two busy cores and with
# kernels to compile: one that takes far longer shows a fault, such as paths that do not end. Sanitizers and debug builds are slower.
if(CMAKE_BUILD_TYPE STREQUAL Release AND NOT KILOBAND_SANITIZE)
  set(KILOBAND_TEST_SECONDS 300)
else()
  set(KILOBAND_TEST_SECONDS 900)
endif()

# kiloband_discover(name [options...] [PROPERTIES ...]): ctest knows the tests of a program one by one, with the label that
# KILOBAND_TEST_LABEL has (tests/CMakeLists.txt). Their names are those that --gtest_filter takes, without values of parameters: what a test
# has cost ctest notes under its name up to the first space, and bytes of a parameter, some of them addresses, change from build to build.
function(kiloband_discover name)
  cmake_parse_arguments(ARG "" "" "PROPERTIES" ${ARGN})
  gtest_discover_tests(${name} ${ARG_UNPARSED_ARGUMENTS} NO_PRETTY_VALUES DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT ${KILOBAND_TEST_SECONDS} LABELS "${KILOBAND_TEST_LABEL}" ${ARG_PROPERTIES})
endfunction()

# kiloband_test(name [OPTIMISED] SOURCES ... DEPENDS ...): a GoogleTest program. OPTIMISED: kiloband_test_options.
function(kiloband_test name)
  cmake_parse_arguments(ARG "OPTIMISED" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE kiloband_flags ${ARG_DEPENDS} GTest::gtest GTest::gtest_main)
  kiloband_test_options(${name} "${ARG_OPTIMISED}")
  target_compile_definitions(${name} PRIVATE KILOBAND_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                             KILOBAND_BINARY_DIR="${PROJECT_BINARY_DIR}")
  kiloband_discover(${name})
endfunction()

# kiloband_test_environment(list variables...): the environment of the tests in `list` (the TEST_LIST of gtest_discover_tests, which
# by itself would set the first variable alone: its PROPERTIES take no lists). The first test of every suite runs before the others
# (which need not pass, nor run, for them): side by side, all would compile the kernels that they share.
function(kiloband_test_environment list)
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${list}_environment.cmake)
  file(WRITE ${script} "foreach(test IN LISTS ${list})\n"
                       "  set_tests_properties(\"\${test}\" PROPERTIES ENVIRONMENT [==[${ARGN}]==])\n"
                       "  string(REGEX MATCH \"^(opencl[.])?[^.]*\" suite \"\${test}\")\n"
                       "  if(NOT DEFINED \"first_of_\${suite}\")\n"
                       "    set(\"first_of_\${suite}\" \"\${test}\")\n"
                       "  elseif(NOT first_of_\${suite} STREQUAL test)\n"
                       "    set_tests_properties(\"\${test}\" PROPERTIES DEPENDS \"\${first_of_\${suite}}\")\n"
                       "  endif()\n"
                       "endforeach()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
endfunction()

# What tests that run kernels need: leaks of PoCL itself are not ours to report, caches stay in the build folder.
set(KILOBAND_OPENCL_ENVIRONMENT
    "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/unit/shared/lsan_suppressions.txt:print_suppressions=0"
    "XDG_CACHE_HOME=${PROJECT_BINARY_DIR}/cache" "POCL_CACHE_DIR=${PROJECT_BINARY_DIR}/cache/pocl")

# kiloband_opencl_test(name [OPTIMISED] SOURCES ... DEPENDS ...): the same for tests that run kernels.
function(kiloband_opencl_test name)
  cmake_parse_arguments(ARG "OPTIMISED" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE kiloband_flags ${ARG_DEPENDS} OpenCL::OpenCL OpenCL::HeadersCpp GTest::gtest
                                        GTest::gtest_main)
  kiloband_test_options(${name} "${ARG_OPTIMISED}")
  target_compile_definitions(${name} PRIVATE KILOBAND_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                             KILOBAND_BINARY_DIR="${PROJECT_BINARY_DIR}")
  kiloband_discover(${name})
  kiloband_test_environment(${name}_TESTS ${KILOBAND_OPENCL_ENVIRONMENT})
endfunction()

# kiloband_test_on(name backend [filter]): the tests of a program once more, on another backend
# (tests/support/render_harness.hpp). filter: of GoogleTest, for those that are about one backend. A test that the CPU, the
# harness's default, has rendered after all fails, whatever it found.
function(kiloband_test_on name backend)
  set(filter "*")
  if(ARGC GREATER 2)
    set(filter ${ARGV2})
  endif()
  kiloband_discover(${name} TEST_FILTER "${filter}" TEST_PREFIX "${backend}." TEST_LIST ${name}_${backend}
                    PROPERTIES FAIL_REGULAR_EXPRESSION "rendered by cpu")
  kiloband_test_environment(${name}_${backend} ${KILOBAND_OPENCL_ENVIRONMENT} KILOBAND_TEST_BACKEND=${backend})
endfunction()
