//! The table of w and c in `docs/commands.md`: its units are those of the columns, its formulas their values.

use crate::table::scene;
use std::collections::HashMap;

const PAGE: &str = include_str!("../../../../docs/commands.md");

/// A slider-crank with r = 0.1 m and l = 0.3 m, driven by its crank or by its slide, under a load of each kind in the plane.
fn slider_crank(actuator: &str, start: &str) -> String {
    format!(
        r#"
[bodies]
ground = {{ points = {{ A = [0, 0] }} }}
crank = {{ points = {{ A = [0, 0], B = [0.1, 0] }}, mass = 2, center = [0.1, 0], inertia = 0.01 }}
rod = {{ points = {{ B = [0, 0], C = [0.3, 0] }} }}
piston = {{ points = {{ C = [0, 0] }}, mass = 1, center = "C", inertia = 0.01 }}
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "rod.B"] }}
C = {{ revolute = ["rod.C", "piston.C"] }}
guide = {{ prismatic = ["ground.A", "piston.C"], axis = [1, 0] }}
[actuators]
{actuator}
[assembly]
rod = -0.3
{start}
[loads]
gravity = {{ gravity = [0, -9.81] }}
force = {{ force = "piston.C", direction = [1, 0], magnitude = 1 }}
torque = {{ torque = "crank", magnitude = 1 }}
point-to-point-force = {{ point-to-point-force = ["ground.A", "piston.C"], magnitude = 1 }}
slide-force = {{ slide-force = "guide", magnitude = 1 }}
spring = {{ spring = ["ground.A", "piston.C"], stiffness = 1, free-length = 0.25 }}
torsion-spring = {{ torsion-spring = ["ground", "crank"], stiffness = 1, free-angle = 0.3 }}
damper = {{ damper = ["ground.A", "piston.C"], damping = 1 }}
rotational-damper = {{ rotational-damper = ["ground", "crank"], damping = 1 }}
"#
    )
}

/// By kind of load: the last four cells of its row.
fn documented() -> HashMap<&'static str, Vec<&'static str>> {
    let (_, section) = PAGE.split_once("\n## w and c of the loads\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let row = |line: &'static str| {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        let kind = cells.next().unwrap().trim_matches('`');
        (kind, cells.skip(3).collect())
    };
    rows.map(row).collect()
}

/// Kinds of the plane that the page documents; those of space have the units of their likes.
#[test]
fn w_and_c_have_the_documented_units_and_values() {
    let documented = documented();
    for (actuator, start, of_w) in [
        ("q = { angle = [\"ground\", \"crank\"] }", "q = 1", 0),
        ("q = { length = \"guide\" }", "q = 0.35\ncrank = 1", 1),
    ] {
        let scene = scene(&slider_crank(actuator, start));
        let reduction = dwell_study::compute_reduction(&scene, Some(7)).unwrap();
        let table = reduction.table();
        let column = |name: String| {
            let mut columns = table.columns.iter();
            let k = columns.position(|column| column.name == name);
            k.unwrap_or_else(|| panic!("no column {name}"))
        };
        let unit = |name: String| match &table.columns[column(name)].unit[..] {
            "" => "1".to_owned(),
            unit => unit.to_owned(),
        };
        for load in &scene.loads {
            let (kind, cells) = (&load.name, &documented[&load.name[..]]);
            assert_eq!(unit(format!("{kind}.w")), cells[of_w], "w of {kind}");
            let reactions = [("guide.normal", cells[2]), ("guide.moment", cells[3])];
            for (reaction, wanted) in reactions {
                assert_eq!(unit(format!("{reaction}.c.{kind}")), wanted, "c of {kind}");
            }
        }
        for row in table.rows.iter().filter(|_| of_w == 0) {
            let (q, x) = (row[0], |q: f64| {
                0.1 * q.cos() + (0.09 - (0.1 * q.sin()).powi(2)).sqrt()
            });
            let slope = 0.5e6 * (x(q + 1e-6) - x(q - 1e-6));
            for (kind, wanted) in [
                ("gravity", -2.0 * 0.1 * q.cos()),
                ("force", slope),
                ("torque", 1.0),
                ("point-to-point-force", slope),
                ("slide-force", slope),
                ("spring", -(x(q) - 0.25) * slope),
                ("torsion-spring", -(q - 0.3)),
                ("damper", -slope),
                ("rotational-damper", -1.0),
            ] {
                let w = row[column(format!("{kind}.w"))];
                assert!((w - wanted).abs() < 1e-9, "{kind} at {q}: {w}, {wanted}");
            }
        }
    }
}
