# How targets of this repository are declared: one function for each kind, so that flags, include
# roots and registration with CTest are said once.

# What all that shares precompiled headers must be compiled with, generated files too.
add_compile_options(-pthread)
# GCC collects its garbage whenever its memory has grown by a third, which takes a fifth of its time
# for files like ours. 1 GB is more than most of them need.
add_compile_options(
  "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:SHELL:--param ggc-min-heapsize=1000000 --param ggc-min-expand=200>")

add_library(mortise_flags INTERFACE)
target_include_directories(mortise_flags INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(mortise_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Werror)
# GCC 12 reports false positives inside inlined third-party templates for these at -O2.
target_compile_options(mortise_flags INTERFACE
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow
  -Wno-stringop-overread -Wno-restrict -Wno-dangling-pointer>)

# mortise_precompile(<name> <optimisation> [header ...])
# The third-party headers that most files include, precompiled once for everything that is compiled
# with that optimisation: parsing them took 1.5 to 3 s of a file's 3 to 15. The presets for debugging
# do without (CMAKE_DISABLE_PRECOMPILE_HEADERS), so that a file that forgets an include is found.
function(mortise_precompile name optimisation)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE mortise_flags CLI11::CLI11 Eigen3::Eigen gRPC::grpc++
                                        nlohmann_json::nlohmann_json protobuf::libprotobuf)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:${optimisation}>)
  target_precompile_headers(${name} PRIVATE
    ${ARGN} <Eigen/Dense> <Eigen/SparseCore> <absl/status/status.h> <absl/status/statusor.h>
    <absl/strings/str_cat.h> <google/protobuf/message.h> <google/protobuf/map.h>
    <google/protobuf/repeated_field.h> <google/protobuf/generated_message_reflection.h>
    <grpcpp/grpcpp.h> <algorithm> <chrono> <filesystem> <fstream> <functional> <map> <memory>
    <optional> <random> <sstream> <string> <thread> <unordered_map> <vector>)
endfunction()

mortise_precompile(mortise_headers -O2)
mortise_precompile(mortise_brief_headers -O1 <nlohmann/json.hpp>)
# CLI11 defines objects, which every file that sees it compiles for 4 s: only for commands.
mortise_precompile(mortise_command_headers -O1 <CLI/CLI.hpp> <nlohmann/json.hpp>)

# mortise_compile_briefly(<target> [precompiled headers])
# For what talks to others rather than computes: -O1 takes a fifth off the compiler's time, and what
# waits for a socket or a disk runs no slower for it.
function(mortise_compile_briefly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(NOT ARGN)
    set(ARGN mortise_brief_headers)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${ARGN})
endfunction()

# mortise_join_sources(<result> <name> SOURCES a.cpp ... [APART b.cpp ...])
# Sets <result> to what is compiled for the target <name>: files that include eight of the sources each,
# and those APART. What includes gRPC, protobuf, Eigen or gtest spends most of its time on instantiating
# the same templates; eight files as one take a third to a half of the time of eight alone. Their unnamed
# namespaces become one: APART are files that have a name there that another has, too, and those that
# alone take a minute. CMake's own unity builds name files by their absolute paths, so that no two
# clones would share the compiler's cache. The presets for debugging compile each file by itself, so that
# one that forgets an include is found.
function(mortise_join_sources result name)
  cmake_parse_arguments(ARG "" "" "SOURCES;APART" ${ARGN})
  set(compiled ${ARG_APART})
  list(REMOVE_ITEM ARG_SOURCES ${compiled} "")
  list(LENGTH ARG_SOURCES count)
  if(CMAKE_DISABLE_PRECOMPILE_HEADERS OR count LESS 2)
    set(${result} ${ARG_SOURCES} ${compiled} PARENT_SCOPE)
    return()
  endif()
  set(group 0)
  while(ARG_SOURCES)
    list(SUBLIST ARG_SOURCES 0 8 together)
    list(REMOVE_ITEM ARG_SOURCES ${together})
    set(content "")
    foreach(source ${together})
      get_filename_component(path ${source} ABSOLUTE)
      file(RELATIVE_PATH path ${CMAKE_SOURCE_DIR} ${path})
      string(APPEND content "#include \"${path}\"\n")
    endforeach()
    set(file ${CMAKE_CURRENT_BINARY_DIR}/together/${name}_${group}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${content}")
    list(APPEND compiled ${file})
    math(EXPR group "${group} + 1")
  endwhile()
  set(${result} ${compiled} PARENT_SCOPE)
endfunction()

# mortise_library(<name> SOURCES a.cpp ... [APART b.cpp ...] [DEPENDS target ...] [BRIEF | COMMANDS])
# A static library. Headers are found from the root of the repository: "common/base/units.h".
# APART: those of the sources that are not compiled with others; see mortise_join_sources.
# BRIEF: see mortise_compile_briefly; COMMANDS: the same for what reads command lines.
function(mortise_library name)
  cmake_parse_arguments(ARG "BRIEF;COMMANDS" "" "SOURCES;APART;DEPENDS" ${ARGN})
  mortise_join_sources(compiled ${name} SOURCES ${ARG_SOURCES} APART ${ARG_APART})
  add_library(${name} STATIC ${compiled})
  target_link_libraries(${name} PUBLIC mortise_flags ${ARG_DEPENDS})
  if(ARG_BRIEF)
    mortise_compile_briefly(${name})
  elseif(ARG_COMMANDS)
    mortise_compile_briefly(${name} mortise_command_headers)
  else()
    target_precompile_headers(${name} REUSE_FROM mortise_headers)
  endif()
endfunction()

# mortise_embed(<source> <definition> <file>)
# Tells <source>, of the same CMakeLists.txt, the path of a file that it takes into the program with .incbin:
# as <definition>. It includes <definition>_DIGEST, a header that changes as the file does: the compiler's
# cache sees includes only, and would give an object with the file of before.
function(mortise_embed source definition file)
  add_custom_command(
    OUTPUT ${file}.digest.h
    COMMAND ${CMAKE_COMMAND} -DFILE=${file} -DOUTPUT=${file}.digest.h
            -P ${CMAKE_SOURCE_DIR}/cmake/digest_header.cmake
    DEPENDS ${file} ${CMAKE_SOURCE_DIR}/cmake/digest_header.cmake
    VERBATIM)
  set_source_files_properties(${source} PROPERTIES
    OBJECT_DEPENDS "${file};${file}.digest.h"
    COMPILE_DEFINITIONS "${definition}=\"${file}\";${definition}_DIGEST=\"${file}.digest.h\"")
endfunction()

# Every program of a running house, and nothing that only tests or makes data: what `./dev demo` builds.
add_custom_target(house)

# mortise_executable(<name> SOURCES main.cpp ... [DEPENDS target ...])
# A program. Its own sources only read the command line and join libraries. Outside tests/ and tools/ it
# belongs to the house.
function(mortise_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS})
  mortise_compile_briefly(${name} mortise_command_headers)
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(NOT folder MATCHES "^(tests|tools)/")
    add_dependencies(house ${name})
  endif()
endfunction()

# Most tests are not optimised, nor carry line numbers for debuggers: an assertion names its own.
if(MORTISE_BUILD_TESTS)
  mortise_precompile(mortise_test_headers -O0 <gmock/gmock.h> <gtest/gtest.h>)
  target_compile_options(mortise_test_headers PRIVATE $<$<CONFIG:Release>:-g0>)
  target_link_libraries(mortise_test_headers PRIVATE GTest::gmock GTest::gtest)
endif()

# mortise_test(<name> SOURCES x_test.cpp ... [DEPENDS target ...] [TIMEOUT seconds] [LABELS l ...]
#              [RESOURCE_LOCK resource] [APART x_test.cpp ...] [OPTIMIZED])
# A GoogleTest binary, registered as one CTest test. It may read ${MORTISE_SOURCE_DIR} and find
# built programs in ${MORTISE_BIN_DIR} (environment variables). OPTIMIZED is for tests that compute
# much themselves: half the time of compiling a test is optimising its assertions, so the others are
# not; what they test always is. Tests that name one RESOURCE_LOCK never run at the same time.
# APART: as of mortise_library.
function(mortise_test name)
  if(NOT MORTISE_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "OPTIMIZED" "TIMEOUT;RESOURCE_LOCK" "SOURCES;APART;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  mortise_join_sources(compiled ${name} SOURCES ${ARG_SOURCES} APART ${ARG_APART})
  add_executable(${name} ${compiled})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS} GTest::gmock GTest::gtest
                                        GTest::gtest_main)
  if(ARG_OPTIMIZED)
    target_precompile_headers(${name} REUSE_FROM mortise_headers)
  else()
    target_compile_options(${name} PRIVATE "$<$<CONFIG:Release>:-O0;-g0>")
    target_precompile_headers(${name} REUSE_FROM mortise_test_headers)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES
    TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
    ENVIRONMENT "MORTISE_SOURCE_DIR=${CMAKE_SOURCE_DIR};MORTISE_BIN_DIR=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  if(ARG_RESOURCE_LOCK)
    set_tests_properties(${name} PROPERTIES RESOURCE_LOCK ${ARG_RESOURCE_LOCK})
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
    target_precompile_headers(${name} REUSE_FROM mortise_headers)
    add_test(NAME ${name} COMMAND ${name} ${CMAKE_SOURCE_DIR}/tests/fuzz/corpus/${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 120 LABELS fuzz)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
  target_link_libraries(${name} PRIVATE mortise_flags ${ARG_DEPENDS})
endfunction()
