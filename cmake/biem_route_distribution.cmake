# Route "distribution": lmp_biem = own main program + styles, linked to the installed liblammps.
find_package(LAMMPS QUIET CONFIG)
if(NOT LAMMPS_FOUND)
  message(FATAL_ERROR "No installed LAMMPS library was found. On Debian and Ubuntu: apt install "
    "liblammps-dev. Otherwise set LAMMPS_DIR to the folder with LAMMPSConfig.cmake, or build "
    "LAMMPS from source with -DLAMMPS_SOURCE_DIR=<dir>.")
endif()
biem_check_lammps_version(${LAMMPS_VERSION} ${LAMMPS_DIR})
get_target_property(installed_headers LAMMPS::lammps INTERFACE_INCLUDE_DIRECTORIES)

# Distributions ship only some of LAMMPS' headers; these are the ones we meet that may be missing.
set(BIEM_LAMMPS_HEADERS "" CACHE PATH "folder with the LAMMPS headers that the installed one lacks")
set(probes version.h command.h irregular.h neigh_request.h fmt/format.h)
set(missing "")
foreach(probe ${probes})
  if(NOT EXISTS ${installed_headers}/${probe})
    list(APPEND missing ${probe})
  endif()
endforeach()

set(added_headers ${BIEM_LAMMPS_HEADERS})
if(missing AND NOT added_headers)
  set(added_headers ${CMAKE_BINARY_DIR}/lammps_headers)
  if(NOT EXISTS ${added_headers}/complete)
    message(STATUS "LAMMPS headers not in ${installed_headers}: ${missing}; "
      "taking them from the distribution's source package of LAMMPS")
    execute_process(
      COMMAND ${CMAKE_CURRENT_LIST_DIR}/distro_lammps_headers.sh ${installed_headers} ${added_headers}
      RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "The missing LAMMPS headers (${missing}) could not be had from the "
        "distribution's source package; the reason stands above. Either make the source package "
        "reachable (network, a mirror in the apt sources), or unpack the sources of LAMMPS "
        "${LAMMPS_VERSION} yourself and set -DBIEM_LAMMPS_HEADERS=<lammps>/src.")
    endif()
  endif()
endif()
if(added_headers)
  biem_read_lammps_version(${added_headers}/version.h header_version)
  if(NOT header_version EQUAL LAMMPS_VERSION)
    message(FATAL_ERROR "The headers in ${added_headers} are of LAMMPS ${header_version}, the "
      "installed library is ${LAMMPS_VERSION}. Programs built from both would crash. Empty the "
      "build folder, or set -DBIEM_LAMMPS_HEADERS=<dir> to headers of ${LAMMPS_VERSION}.")
  endif()
endif()

# The installed headers come first, so that only what they lack is taken from the added folder.
add_library(biem_lammps INTERFACE)
target_include_directories(biem_lammps SYSTEM INTERFACE ${installed_headers} ${added_headers})
target_link_libraries(biem_lammps INTERFACE LAMMPS::lammps)

biem_add_style_objects(biem_styles)
target_link_libraries(biem_styles PUBLIC biem_lammps)
add_executable(lmp_biem ${BIEM_MAIN_SOURCES})
target_link_libraries(lmp_biem PRIVATE biem_styles biem_lammps)
set_target_properties(lmp_biem PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
message(STATUS "lmp_biem: LAMMPS ${LAMMPS_VERSION} of the distribution, ${LAMMPS_DIR}")
