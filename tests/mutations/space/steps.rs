//! The steps of an evaluation in space, in their order.

/// The step that a function belongs to, with its place in the order of evaluation. Every function in which a mutation was
/// tried must be named here.
pub fn evaluation_step(path: &str, function: &str) -> Option<(usize, &'static str)> {
    let path = path.replace('\\', "/");
    // An operator that is passed as a function, such as `Vec3::cast`, is called from the standard library or from `map_array`.
    if path.contains("library/core/") || path.ends_with("numerics/src/scalar.rs") {
        return Some((18, "operators passed as functions, number types"));
    }
    let module = path.trim_start_matches("crates/").trim_end_matches(".rs");
    let (name, module) = module.split_once("/src/")?;
    Some(match (name, module, function) {
        ("geometry", "space/follow" | "space/prediction" | "space/stations", _) => {
            (0, "predictions of poses")
        }
        ("geometry", "space/vector", _) => (2, "rotations"),
        ("geometry", "space/frames", "motion") => (7, "velocities along the tree"),
        ("geometry", "space/frames", "added") => (9, "accelerations along the tree"),
        ("geometry", "space/frames", "force_power" | "moment_power" | "twist") => {
            (5, "screws and wrenches: the Jacobian")
        }
        (
            "geometry",
            "space/frames",
            "point_velocity" | "point_acceleration" | "direction_derivatives",
        ) => (8, "velocities and accelerations of points"),
        ("geometry", "space/frames", _) => (1, "frames along the tree"),
        ("geometry", "space/closure", "row" | "ends") => (3, "rows of closures"),
        ("geometry", "space/closure", _) => (10, "accelerations of closures"),
        ("geometry", "space/positions", _) => (4, "positions: predicted steps and Newton"),
        ("geometry", "space/factors" | "space/groups", _) => (6, "groups: scales"),
        ("geometry", "space/rod", _) => (6, "groups: a rod between two balls"),
        ("numerics", "lu" | "factor_outcome", _) => (6, "groups: elimination"),
        ("numerics", "qr", _) => (6, "groups: least squares"),
        ("geometry", "space/motion", _) => (11, "rates of the freedoms, motions of bodies"),
        ("geometry", "space/multipliers", "balance" | "carry_down") => {
            (12, "forces along the tree")
        }
        ("geometry", "space/multipliers", "multipliers" | "close_forces" | "add_row") => {
            (13, "multipliers and forces of closures")
        }
        ("geometry", "space/multipliers" | "space/plan" | "space/wrench", _) => {
            (14, "reactions and actions")
        }
        ("geometry", "space/coordinate", _) => (15, "coordinates of loads"),
        ("kinetostatics", "space/mass", _) => (16, "inertia forces"),
        ("kinetostatics", "friction" | "space/friction" | "space/surface_friction", _) => {
            (19, "friction")
        }
        ("kinetostatics", _, _) if module.starts_with("load") => (17, "magnitudes of loads"),
        ("kinetostatics", "space/action" | "space/load" | "space/compiled_loads", _) => {
            (17, "loads")
        }
        ("kinetostatics", _, _) => (14, "reactions and actions"),
        ("laws", _, _) => (17, "magnitudes of loads"),
        _ => return None,
    })
}
