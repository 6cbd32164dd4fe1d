"""Parts of the model and of the output: the modules, and procedures (`module:procedure`) of modules
that all decks need, which exist for that part only."""

CONTACT_FOLDER = {
    "active_set", "contact_tractions", "chain_geometry", "closing_instant", "lemke_path",
    "contact_factors", "contact_pairs", "contact_system", "contact_workspace",
    "interface_checks", "interface_warnings", "surface_chains", "zone_edges",
}
COUPLING = {
    "arnoldi", "closing_instant:contact_response", "closing_instant:make_tangent",
    "conductance_graph", "contact_operator:contact_operator_pass", "contact_operator:make_graph",
    "contact_operator:opening_changes", "contact_operator:opening_derivative",
    "contact_operator:openings", "contact_operator:residual_floor", "coupled_increment",
    "fixed_point", "increment_iteration", "jump_loads", "newton",
}
PARTS = {
    "heat": {
        "balances:balance_heat", "edge_heat:supplied_heat",
        "field_recovery:heat_flux_samples", "material_points:heat_flux",
        "increment_solution:conduct", "heat_equation", "heat_reduction", "jump_loads", "loads:card_heat",
        "loads:film_matrix", "loads:heat_load", "unit_loads:location_heat", "point_materials:conductivity_in",
        "thermal_matrix",
    },
    "strain by heat": {
        "contact_operator:unstrained_forces", "element_elasticity:element_thermal_load",
        "point_materials:thermal_modulus_in", "stiffness_matrix:assemble_thermal_load",
    },
    "mechanics": CONTACT_FOLDER - {
        # Pairs conduct, whether bodies move or not: these make them and their results.
        "contact_tractions", "chain_geometry", "contact_pairs", "interface_checks",
        "interface_warnings", "surface_chains", "zone_edges"} | {
        "balances:contact_violation", "balances:force_residual", "equilibrium_reduction",
        "element_elasticity", "field_recovery:stress_samples", "material_points:stress",
        "increment_checks:warn_of_choices",
        "balances:balance_forces", "increment_solution:remember_slip",
        "increment_solution:load_mechanics", "point_materials:elasticity_in",
        "stiffness_matrix",
    },
    "contact": CONTACT_FOLDER | COUPLING | {
        "balances:contact_violation", "conductance_laws", "contact_operator:law_conductance",
        "contact_heat:temperature_jumps", "equilibrium_reduction:set_cycles",
        "equilibrium_reduction:set_motions", "deck_builder_contact",
        "deck_builder_gap_laws", "deck_builder_interactions",
        "increment_records:contact_record",
        "increment_solution:remember_slip", "increment_solution:conduct",
        "listing_increments:print_interface", "listing_tables:print_contact_table",
        "interface_reports", "connections", "contact_points",
        "result_fields:face_values",
        "result_fields:find_faces", "listing_tables:add_increment", "listing_tables:print_diagram",
    },
    "friction": {
        "contact_system:next_contact_state", "contact_system:combine", "zone_edges:stick_edges",
    },
    "coupling": COUPLING,
    "cycles of contact points": {"field_constraints:stiffness_alone", "linear_constraints:links"},
    "paths to a contact zone": {"lemke_path"},
    "bodies that contact holds": {"active_set:hold_softly",
                                  "contact_system:free_motions", "tail_motions:is_driven",
                                  "tail_motions:least_drive"},
    "films": {"loads:film_matrix", "unit_loads:film_matrix"},
    "estimated errors": {
        "body_maxima", "companion_states", "contact_extents", "divided_mesh", "error_estimator",
        "quantity_histories", "uncertainty_rule",
    },
    "refinement": {"local_refinement", "mesh_division", "refinement"},
    "printed tables": {"increment_records:points_of_set", "listing_tables:print_contact_table",
                       "listing_tables:print_nodes", "listing_tables:print_points"},
    "checks of the deck": {"deck_builder_verify", "interface_reports:check_arc_lengths",
                           "verification"},
    "MUMPS": {"mumps_solver", "ordering:nested_dissection"},
}
