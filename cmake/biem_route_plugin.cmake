# Route "plugin": biemplugin.so for `plugin load` of a LAMMPS that has the PLUGIN package.
# The headers must be those of that very LAMMPS; the plugin checks it when it is loaded.
set(BIEM_LAMMPS_SIZES SMALLBIG CACHE STRING "integer sizes of that LAMMPS: SMALLBIG or BIGBIG")
if(NOT EXISTS ${LAMMPS_HEADER_DIR}/lammpsplugin.h)
  message(FATAL_ERROR "LAMMPS_HEADER_DIR=${LAMMPS_HEADER_DIR} has no lammpsplugin.h. Give the src "
    "folder of the LAMMPS that will load the plugin: -DLAMMPS_HEADER_DIR=<lammps>/src.")
endif()
biem_read_lammps_version(${LAMMPS_HEADER_DIR}/version.h version)
biem_check_lammps_version(${version} ${LAMMPS_HEADER_DIR})

add_library(biem_lammps INTERFACE)
target_include_directories(biem_lammps SYSTEM INTERFACE ${LAMMPS_HEADER_DIR})
target_compile_definitions(biem_lammps INTERFACE LAMMPS_${BIEM_LAMMPS_SIZES})

biem_add_style_objects(biem_styles)
target_link_libraries(biem_styles PUBLIC biem_lammps)
add_library(biemplugin MODULE ${BIEM_PLUGIN_SOURCES})
target_link_libraries(biemplugin PRIVATE biem_styles biem_lammps)
# The plugin uses its own copy of the core, whatever the program that loads it contains.
target_link_options(biemplugin PRIVATE -Wl,-Bsymbolic)
set_target_properties(biemplugin PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
message(STATUS "biemplugin.so: for LAMMPS ${version}, headers in ${LAMMPS_HEADER_DIR}")
