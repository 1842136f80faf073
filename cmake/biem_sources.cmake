# The one list of source files.  A test (tests/layering) holds it against the folder.
set(BIEM_SOURCE_DIR ${CMAKE_CURRENT_LIST_DIR}/../src/USER-BIEM)

# Core: namespace biem, no LAMMPS header.
set(BIEM_CORE_SOURCES
  biem_body_load.cpp
  biem_contact_law.cpp
  biem_contact_slots.cpp
  biem_coupled_system.cpp
  biem_coupled_walls.cpp
  biem_element_flat.cpp
  biem_ewald_cost.cpp
  biem_ewald_error_model.cpp
  biem_ewald_fourier.cpp
  biem_ewald_grid.cpp
  biem_ewald_parameters.cpp
  biem_ewald_polynomial.cpp
  biem_ewald_real_space.cpp
  biem_ewald_slab.cpp
  biem_ewald_split.cpp
  biem_ewald_split_pswf.cpp
  biem_ewald_spread.cpp
  biem_ewald_sum.cpp
  biem_ewald_transform.cpp
  biem_ewald_tuning.cpp
  biem_ewald_window.cpp
  biem_membrane_bend.cpp
  biem_membrane_skalak.cpp
  biem_mesh_clearance.cpp
  biem_mesh_crossings.cpp
  biem_mesh_file.cpp
  biem_mesh_icosphere.cpp
  biem_mesh_moments.cpp
  biem_mesh_nearest_point.cpp
  biem_mesh_obstacles.cpp
  biem_mesh_packing.cpp
  biem_mesh_packing_contacts.cpp
  biem_mesh_shape.cpp
  biem_mesh_sheets.cpp
  biem_mesh_signed_distance.cpp
  biem_mesh_topology.cpp
  biem_mesh_translations.cpp
  biem_mesh_wall.cpp
  biem_near_correction.cpp
  biem_near_triangle.cpp
  biem_operator_body.cpp
  biem_operator_layers.cpp
  biem_operator_row_sums.cpp
  biem_oracle_periodic.cpp
  biem_periodic_ghosts.cpp
  biem_rigid_motion.cpp
  biem_scene.cpp
  biem_solver_body.cpp
  biem_solver_gmres.cpp
  biem_solver_wall.cpp
  biem_stepper.cpp
  biem_stepper_rkc.cpp
  biem_surface_hold.cpp
  biem_surface_modes.cpp
  biem_surface_replicas.cpp
  biem_surface_subset.cpp
  biem_suspension.cpp
)

# Bridge: the only part of the package that knows both the core and LAMMPS.
set(BIEM_BRIDGE_SOURCES
  biem_lammps_atom_directory.cpp
  biem_lammps_bridge.cpp
  biem_lammps_cell_creation.cpp
  biem_lammps_cell_settings.cpp
  biem_lammps_closing.cpp
  biem_lammps_command_arguments.cpp
  biem_lammps_contact_messages.cpp
  biem_lammps_contact_surfaces.cpp
  biem_lammps_contacts.cpp
  biem_lammps_crossing_search.cpp
  biem_lammps_evaluator.cpp
  biem_lammps_gather.cpp
  biem_lammps_history.cpp
  biem_lammps_integrator.cpp
  biem_lammps_integrator_steps.cpp
  biem_lammps_output.cpp
  biem_lammps_overlap_check.cpp
  biem_lammps_parameters.cpp
  biem_lammps_particles.cpp
  biem_lammps_report.cpp
  biem_lammps_script_check.cpp
  biem_lammps_settings.cpp
  biem_lammps_sheared_box.cpp
  biem_lammps_solver.cpp
  biem_lammps_stage_forces.cpp
  biem_lammps_stiffness.cpp
  biem_lammps_surface_command.cpp
  biem_lammps_topology.cpp
  biem_lammps_wall_settings.cpp
  biem_lammps_watchdog.cpp
)

# Styles: LAMMPS classes behind the commands of the input script.
set(BIEM_STYLE_SOURCES
  angle_biem_skalak.cpp
  compute_biem_cell.cpp
  create_cells.cpp
  create_wall.cpp
  dihedral_biem_bend.cpp
  fix_biem.cpp
  pair_biem_contact.cpp
)

# Entry points, one for each way to bring the styles into LAMMPS.
set(BIEM_MAIN_SOURCES biem_main.cpp)
set(BIEM_PLUGIN_SOURCES biemplugin.cpp)

foreach(list CORE BRIDGE STYLE MAIN PLUGIN)
  list(TRANSFORM BIEM_${list}_SOURCES PREPEND ${BIEM_SOURCE_DIR}/)
endforeach()
