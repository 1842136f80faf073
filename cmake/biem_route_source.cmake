# Route "source tree": LAMMPS itself is built here, with the styles in its own lists of styles.
if(NOT EXISTS ${BIEM_LAMMPS_DIR}/cmake/CMakeLists.txt)
  message(FATAL_ERROR "LAMMPS_SOURCE_DIR=${BIEM_LAMMPS_DIR} has no cmake/CMakeLists.txt. Give the "
    "top folder of a LAMMPS source tree, the one with src/ and cmake/.")
endif()
biem_read_lammps_version(${BIEM_LAMMPS_DIR}/src/version.h version)
biem_check_lammps_version(${version} ${BIEM_LAMMPS_DIR})
biem_announce_styles()

# Defaults for a newcomer, each open to -D on the command line.
set(BUILD_SHARED_LIBS ON CACHE BOOL "LAMMPS as a shared library")
set(BUILD_MPI ON CACHE BOOL "LAMMPS with MPI")
set(BUILD_OMP OFF CACHE BOOL "LAMMPS with OpenMP")
set(LAMMPS_MACHINE biem CACHE STRING "suffix of the program")
foreach(package MOLECULE KSPACE RIGID EXTRA-COMPUTE EXTRA-FIX)
  set(PKG_${package} ON CACHE BOOL "LAMMPS package")
endforeach()
foreach(library PNG JPEG GZIP FFMPEG CURL)
  set(WITH_${library} OFF CACHE BOOL "optional library of LAMMPS")
endforeach()
add_subdirectory(${BIEM_LAMMPS_DIR}/cmake ${CMAKE_BINARY_DIR}/lammps)

biem_add_style_objects(biem_styles)
target_include_directories(biem_styles SYSTEM PRIVATE ${BIEM_LAMMPS_DIR}/src)
target_compile_definitions(biem_styles PRIVATE $<TARGET_PROPERTY:lammps,COMPILE_DEFINITIONS>)
target_sources(lammps PRIVATE $<TARGET_OBJECTS:biem_styles>)
target_include_directories(lammps PRIVATE ${BIEM_SOURCE_DIR})
# By its file, not as a target: LAMMPS keeps its own compiler flags.
add_dependencies(lammps biem_core)
target_link_libraries(lammps PRIVATE
  $<TARGET_FILE:biem_core> ${BIEM_FFTW_LIBRARY})
set_target_properties(lmp PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
add_custom_target(lmp_biem)    # the same name of the target in every route
add_dependencies(lmp_biem lmp)
message(STATUS "lmp_biem: LAMMPS ${version} built from ${BIEM_LAMMPS_DIR}")
