//! Names that columns and results had before they were renamed: requests and references may still use them.

/// Endings of columns, as they are and as they were. The first that fits decides.
const COLUMNS: [(&str, &str); 21] = [
    (".angular_velocity", ".speed"),
    (".velocity", ".speed"),
    (".angular_acceleration", ".acceleration"),
    (".actuator_force", ".action"),
    (".velocity_ratio", ".ratio"),
    (".mechanical_advantage", ".advantage"),
    (".velocity_pole.x", ".pole.x"),
    (".velocity_pole.y", ".pole.y"),
    (".acceleration_pole.x", ".acceleration-pole.x"),
    (".acceleration_pole.y", ".acceleration-pole.y"),
    (".transmission_angle", ".transmission"),
    (".load_force", ".load"),
    (".load_moment", ".load"),
    ("shaking.moment", "frame.m"),
    ("shaking.fx", "frame.fx"),
    ("shaking.fy", "frame.fy"),
    ("power.kinetic", "balance.dE/dt"),
    ("power.actuators", "balance.actuators"),
    ("power.loads", "balance.loads"),
    ("power.residual", "balance.residual"),
    ("energy.kinetic_bodies", "balance.energy"),
];

/// Results of a sweep.
const RESULTS: [(&str, &str); 6] = [
    (".min", ".least"),
    (".max", ".most"),
    ("range.lower", "range.from"),
    ("range.upper", "range.to"),
    (".actuator_force.max_abs", ".action.peak"),
    (".max_abs", ".peak"),
];

/// The former name of a column, where it had another one.
pub fn former_column(current: &str) -> Option<String> {
    former(&COLUMNS, current)
}

/// The former name of a sweep's result, where it had another one.
pub fn former_result(current: &str) -> Option<String> {
    former(&RESULTS, current)
}

fn former(endings: &[(&str, &str)], current: &str) -> Option<String> {
    let one = |(now, then): &(&str, &str)| Some(format!("{}{then}", current.strip_suffix(now)?));
    endings.iter().find_map(one)
}

/// The columns that a former name may have become.
pub fn current_columns(former: &str) -> impl Iterator<Item = String> {
    let one =
        move |(now, then): &(&str, &str)| Some(format!("{}{now}", former.strip_suffix(then)?));
    COLUMNS.iter().filter_map(one)
}

/// The line of a summary that names the current forms of a former name; empty if there are none.
pub fn note(former: &str, current: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let current = current.into_iter();
    let current: Vec<String> = current.map(|name| format!("`{}`", name.as_ref())).collect();
    match current.as_slice() {
        [] => String::new(),
        names => format!("  note: `{former}` is now called {}\n", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_at_most_one_former_name() {
        for (current, before) in [
            ("phi.velocity", "phi.speed"),
            ("crank.angular_velocity", "crank.speed"),
            ("crank.angular_acceleration", "crank.acceleration"),
            ("rod.P.mechanical_advantage", "rod.P.advantage"),
            ("rod.velocity_pole.x", "rod.pole.x"),
            ("spring.load_moment", "spring.load"),
            ("shaking.moment", "frame.m"),
            ("power.kinetic", "balance.dE/dt"),
        ] {
            assert_eq!(former_column(current).as_deref(), Some(before));
            assert!(current_columns(before).any(|name| name == current));
        }
        assert_eq!(former_column("phi.acceleration"), None);
        assert_eq!(
            former_result("phi.actuator_force.max_abs").as_deref(),
            Some("phi.action.peak")
        );
        assert_eq!(former_result("A.x.max_abs").as_deref(), Some("A.x.peak"));
    }
}
