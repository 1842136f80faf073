# Brings the styles into LAMMPS.  Three routes, from the same sources:
#   distribution   lmp_biem: own main program linked to the installed liblammps        (default)
#   source tree    -DLAMMPS_SOURCE_DIR=<dir>: LAMMPS is built here with the styles inside
#   plugin         -DBIEM_PLUGIN=on: biemplugin.so, for the command `plugin load`
# The LAMMPS tree or installation is never written to.

# Styles and bridge as objects; the target that takes them tells which LAMMPS they are for.
function(biem_add_style_objects name)
  add_library(${name} OBJECT ${BIEM_STYLE_SOURCES} ${BIEM_BRIDGE_SOURCES})
  target_link_libraries(${name} PUBLIC biem_core)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

# LAMMPS' CMake collects style headers in GLOBAL properties (FIX, ANGLE, ...) before it writes its
# lists of styles, so appending ours first is enough.
function(biem_announce_styles)
  file(GLOB headers CONFIGURE_DEPENDS ${BIEM_SOURCE_DIR}/*.h)
  foreach(header ${headers})
    foreach(kind ANGLE DIHEDRAL PAIR FIX COMPUTE COMMAND)
      file(STRINGS ${header} guard LIMIT_COUNT 1 REGEX "^ *#ifdef ${kind}_CLASS")
      if(guard)
        set_property(GLOBAL APPEND PROPERTY ${kind} ${header})
      endif()
    endforeach()
  endforeach()
endfunction()

# "29 Sep 2021" in version.h -> 20210929
function(biem_read_lammps_version file result)
  file(STRINGS ${file} line LIMIT_COUNT 1 REGEX "LAMMPS_VERSION")
  if(NOT line MATCHES "\"([0-9]+) ([A-Z][a-z][a-z])[a-z]* ([0-9]+)\"")
    message(FATAL_ERROR "${file} has no line of the form #define LAMMPS_VERSION \"29 Sep 2021\". "
      "Is this LAMMPS' own version.h?")
  endif()
  set(day ${CMAKE_MATCH_1})
  set(year ${CMAKE_MATCH_3})
  list(FIND BIEM_MONTHS ${CMAKE_MATCH_2} month)
  math(EXPR number "${year} * 10000 + (${month} + 1) * 100 + ${day}")
  set(${result} ${number} PARENT_SCOPE)
endfunction()
set(BIEM_MONTHS Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec)

function(biem_check_lammps_version version where)
  if(version LESS 20210929)
    message(FATAL_ERROR "LAMMPS in ${where} is of ${version}; this package needs 29 Sep 2021 "
      "(20210929) or later. Give a newer source tree with -DLAMMPS_SOURCE_DIR=<dir>.")
  endif()
endfunction()
