# How targets of this repository are declared: one function for each kind, so that flags, include
# roots and registration with CTest are said once.

add_library(mortise_flags INTERFACE)
target_include_directories(mortise_flags INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(mortise_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Werror)
# GCC 12 reports false positives inside inlined third-party templates for these at -O2.
target_compile_options(mortise_flags INTERFACE
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow
  -Wno-stringop-overread -Wno-restrict -Wno-dangling-pointer>)

# mortise_library(<name> SOURCES a.cpp ... [DEPENDS target ...])
# A static library. Headers are found from the root of the repository: "common/base/units.h".
function(mortise_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC mortise_flags ${ARG_DEPENDS})
endfunction()

# mortise_compile_briefly(<target>)
# For what talks to others rather than computes: -O1 takes a fifth off the compiler's time, and what
# waits for a socket or a disk runs no slower for it.
function(mortise_compile_briefly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# mortise_executable(<name> SOURCES main.cpp ... [DEPENDS target ...])
# A program. Its own sources only read the command line and join libraries.
function(mortise_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS})
  mortise_compile_briefly(${name})
endfunction()

# The headers that every test includes, precompiled once for all of them: a third of the time of
# compiling an average test. Everything that may use them is compiled with the same flags.
if(MORTISE_BUILD_TESTS)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/test_headers.cpp CONTENT "")
  add_library(mortise_test_headers OBJECT ${CMAKE_BINARY_DIR}/test_headers.cpp)
  target_link_libraries(mortise_test_headers PRIVATE mortise_flags GTest::gmock GTest::gtest)
  target_compile_options(mortise_test_headers PRIVATE -pthread $<$<CONFIG:Release>:-O0>)
  target_precompile_headers(mortise_test_headers PRIVATE
    <gmock/gmock.h> <gtest/gtest.h> <absl/status/status.h> <absl/status/statusor.h>
    <chrono> <filesystem> <fstream> <functional> <map> <memory> <optional> <random> <sstream>
    <string> <thread> <vector>)
endif()

# mortise_test(<name> SOURCES x_test.cpp ... [DEPENDS target ...] [TIMEOUT seconds] [LABELS l ...]
#              [RUN_SERIAL] [OPTIMIZED])
# A GoogleTest binary, registered as one CTest test. It may read ${MORTISE_SOURCE_DIR} and find
# built programs in ${MORTISE_BIN_DIR} (environment variables). OPTIMIZED is for tests that compute
# much themselves: half the time of compiling a test is optimising its assertions, so the others are
# not; what they test always is.
function(mortise_test name)
  if(NOT MORTISE_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "RUN_SERIAL;OPTIMIZED" "TIMEOUT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS} GTest::gmock GTest::gtest
                                        GTest::gtest_main)
  if(NOT ARG_OPTIMIZED)
    target_compile_options(${name} PRIVATE -pthread $<$<CONFIG:Release>:-O0>)
    target_precompile_headers(${name} REUSE_FROM mortise_test_headers)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES
    TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
    ENVIRONMENT "MORTISE_SOURCE_DIR=${CMAKE_SOURCE_DIR};MORTISE_BIN_DIR=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  if(ARG_RUN_SERIAL)
    set_tests_properties(${name} PROPERTIES RUN_SERIAL TRUE)
  endif()
endfunction()

add_custom_target(benches)

# mortise_bench(<name> SOURCES x_bench.cpp ... [DEPENDS target ...])
# A benchmark program under build/<preset>/bench. Not part of CTest nor of a plain build: `./dev bench`
# builds the target `benches` and runs them all.
function(mortise_bench name)
  if(NOT MORTISE_BUILD_BENCHES)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench)
  add_dependencies(benches ${name})
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS} benchmark::benchmark)
endfunction()

# mortise_fuzz(<name> SOURCES x_fuzz.cpp [DEPENDS target ...])
# A libFuzzer target (clang, preset `fuzz`). Without clang the same source is linked with
# tests/fuzz/replay_main.cpp, which feeds it the corpus, so that every fuzz target runs in CTest.
function(mortise_fuzz name)
  if(NOT MORTISE_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(MORTISE_BUILD_FUZZERS)
    add_executable(${name} ${ARG_SOURCES})
    target_compile_options(${name} PRIVATE -fsanitize=fuzzer)
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  else()
    add_executable(${name} ${ARG_SOURCES} ${CMAKE_SOURCE_DIR}/tests/fuzz/replay_main.cpp)
    add_test(NAME ${name} COMMAND ${name} ${CMAKE_SOURCE_DIR}/tests/fuzz/corpus/${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 120 LABELS fuzz)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS})
endfunction()
