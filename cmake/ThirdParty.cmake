# Every third-party library, found once. Why each was chosen: the table in docs/architecture.md.
# Imported targets are SYSTEM, so their headers raise no warnings.
include(FindPkgConfig)
find_package(Threads REQUIRED)
find_package(Protobuf REQUIRED)
find_package(gRPC CONFIG REQUIRED)
find_package(absl CONFIG REQUIRED)
find_package(Eigen3 CONFIG REQUIRED)
find_package(spdlog CONFIG REQUIRED)
find_package(CLI11 CONFIG REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(PostgreSQL REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(prometheus-cpp CONFIG REQUIRED)
find_package(OpenCASCADE CONFIG REQUIRED)
find_package(OpenMesh CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(NLopt CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(assimp 5.2 CONFIG REQUIRED)
pkg_check_modules(ZeroMQ REQUIRED IMPORTED_TARGET libzmq)
# Of its flag -isystem CMake makes a folder to include when it is configured first, and an option ever
# after. The compiler's cache is only of use to other clones if the flags are the same: always an option.
get_target_property(zeromq_folders PkgConfig::ZeroMQ INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER zeromq_folders EXCLUDE REGEX krb5)
set(zeromq_options $CACHE{ZeroMQ_CFLAGS})
list(FILTER zeromq_options EXCLUDE REGEX "^-I")
set_target_properties(PkgConfig::ZeroMQ PROPERTIES
  INTERFACE_INCLUDE_DIRECTORIES "${zeromq_folders}" INTERFACE_COMPILE_OPTIONS "${zeromq_options}")
pkg_check_modules(Modbus REQUIRED IMPORTED_TARGET libmodbus)
pkg_check_modules(Cares REQUIRED IMPORTED_TARGET libcares)
pkg_check_modules(Clp REQUIRED IMPORTED_TARGET clp)
pkg_check_modules(PNG REQUIRED IMPORTED_TARGET libpng)
pkg_check_modules(Zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(QrEncode REQUIRED IMPORTED_TARGET libqrencode)
pkg_check_modules(XlsxWriter REQUIRED IMPORTED_TARGET xlsxwriter)

# Libraries whose packages bring neither a CMake nor a pkg-config file.
function(mortise_find_library target header)
  find_path(${target}_INCLUDE ${header} PATH_SUFFIXES suitesparse REQUIRED)
  add_library(${target} INTERFACE IMPORTED)
  target_include_directories(${target} SYSTEM INTERFACE ${${target}_INCLUDE})
  foreach(library ${ARGN})
    find_library(${target}_${library} ${library} REQUIRED)
    target_link_libraries(${target} INTERFACE ${${target}_${library}})
  endforeach()
endfunction()
mortise_find_library(mortise_cholmod cholmod.h cholmod openblas)
# The OpenMP that cholmod runs on, to tell it not to.
target_link_libraries(mortise_cholmod INTERFACE -l:libgomp.so.1)
mortise_find_library(mortise_spectra Spectra/SymGEigsShiftSolver.h)
mortise_find_library(mortise_tetgen tetgen.h tet)
mortise_find_library(mortise_haru hpdf.h hpdf)
mortise_find_library(mortise_cgal CGAL/AABB_tree.h gmp mpfr)

# Open CASCADE's own targets say neither where its headers are nor that these belong together.
add_library(mortise_open_cascade INTERFACE IMPORTED)
target_include_directories(mortise_open_cascade SYSTEM INTERFACE ${OpenCASCADE_INCLUDE_DIR})
target_link_libraries(mortise_open_cascade INTERFACE
  TKMesh TKBO TKBool TKFillet TKOffset TKPrim TKTopAlgo TKBRep TKMath TKernel TKG2d TKG3d TKGeomBase
  TKGeomAlgo TKXDESTEP TKSTEP TKSTEPBase TKShHealing TKXSBase TKXCAF TKLCAF TKCAF TKCDF)

# The letters of what is printed.
set(mortise_fonts /usr/share/fonts/truetype/dejavu /usr/share/fonts/TTF /usr/share/fonts)
find_file(MORTISE_PLAIN_FONT DejaVuSans.ttf PATHS ${mortise_fonts} REQUIRED)
find_file(MORTISE_BOLD_FONT DejaVuSans-Bold.ttf PATHS ${mortise_fonts} REQUIRED)

if(MORTISE_BUILD_TESTS OR MORTISE_BUILD_BENCHES)
  find_package(GTest CONFIG REQUIRED)
endif()
if(MORTISE_BUILD_BENCHES)
  find_package(benchmark CONFIG REQUIRED)
  find_package(pagmo CONFIG REQUIRED)
endif()
