//! Arrows of pages by the laws of mechanics: the forces that are drawn on a body at rest balance each other.

use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, JointKind, Vec2, vec2};
use dwell_kinetostatics::{LoadKind, Magnitude, Strength};
use dwell_page::{Anchor, Direction, Drawing, ForceArrow, ForcePart, Page};
use dwell_scene::PlaneScene;
use dwell_study::{Analysis, no_progress, trajectory_page};

const ROWS: usize = 25;

/// A page of statics with the scene's loads.
fn statics(text: &str) -> (PlaneScene, Page) {
    let scene = PlaneScene::parse("scene.toml", text).unwrap();
    let page = trajectory_page(&scene, Analysis::Statics, Some(ROWS), &no_progress);
    let (page, _) = page.unwrap();
    (scene, page)
}

fn case(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
    let text = std::fs::read_to_string(format!("{folder}/{name}/scene.toml")).unwrap();
    // All columns.
    text[..text.find("[requests]").unwrap()].to_owned()
}

fn with_angle(text: &str, teeth: &str) -> String {
    assert_eq!(text.matches(teeth).count(), 1, "{teeth}");
    text.replace(teeth, &format!("{teeth}, pressure-angle = 0.35"))
}

/// A drawing in a row.
struct Row<'a> {
    page: &'a Page,
    drawing: &'a Drawing,
    row: usize,
}

impl Row<'_> {
    fn column(&self, key: &str) -> f64 {
        let mut columns = self.page.columns.iter();
        columns.find(|c| c.key == key).unwrap().values[self.row]
    }

    fn turned(&self, body: usize, v: &[f64]) -> Vec2 {
        let angle = match &self.drawing.bodies[body].placements[..] {
            [] => 0.0,
            all => all[2][self.row],
        };
        let (sin, cos) = angle.sin_cos();
        vec2(cos * v[0] - sin * v[1], sin * v[0] + cos * v[1])
    }

    fn place(&self, at: &Anchor) -> Vec2 {
        let origin = match &self.drawing.bodies[at.body].placements[..] {
            [] => vec2(0.0, 0.0),
            all => vec2(all[0][self.row], all[1][self.row]),
        };
        origin + self.turned(at.body, &at.point)
    }

    /// Where an arrow begins, and its force.
    fn force(&self, arrow: &ForceArrow) -> (Vec2, Vec2) {
        let value = |k: usize| self.page.columns[k].values[self.row];
        match &arrow.direction {
            Direction::Components { columns } => {
                let force = vec2(value(columns[0]), value(columns[1]));
                (self.place(&arrow.at), force)
            }
            Direction::Body {
                body,
                parts,
                offset,
            } => {
                let mut at = self.place(&arrow.at);
                if !offset.is_empty() {
                    at += self.turned(*body, offset);
                }
                let parts = parts.iter();
                let parts = parts.map(|p| self.turned(*body, &p.axis) * value(p.column));
                (at, parts.fold(vec2(0.0, 0.0), |sum, part| sum + part))
            }
            Direction::Line { ends, parts, place } => {
                let [from, to] = [0, 1].map(|k| self.place(&ends[k]));
                let along = (to - from) * (1.0 / (to - from).norm());
                let part = |p: &ForcePart| {
                    (along * p.axis[0] + along.perp() * p.axis[1]) * value(p.column)
                };
                let sum = parts.iter().map(part).fold(vec2(0.0, 0.0), |a, b| a + b);
                (from + (to - from) * *place, sum)
            }
        }
    }
}

/// Force, and moment about the origin of the ground, on each body, by the arrows and the columns of couples.
fn resultants(scene: &PlaneScene, row: &Row<'_>) -> Vec<(Vec2, f64)> {
    let mechanism = &scene.mechanism;
    let mut sums = vec![(vec2(0.0, 0.0), 0.0); mechanism.bodies.len()];
    let mut add = |body: BodyId, at: Vec2, force: Vec2| {
        let sum = &mut sums[body.0];
        *sum = (sum.0 + force, sum.1 + at.cross(force));
    };
    let arrows = &row.drawing.arrows;
    let find = |name: &str| arrows.iter().find(|a| a.name == name);
    for joint in &mechanism.joints {
        let whole = format!("{}.line-of-action", joint.name);
        let Some(arrow) = find(&whole).or_else(|| find(&joint.name)) else {
            continue;
        };
        let (at, force) = row.force(arrow);
        // The force of a coupling acts between the bodies of its travel.
        let bodies = match joint.kind {
            JointKind::Coupling(_) => [BodyId(mechanism.ground), BodyId(arrow.at.body)],
            _ => joint.bodies,
        };
        add(bodies[1], at, force);
        add(bodies[0], at, -force);
        if let Some(back) = find(&format!(
            "{} on {}",
            arrow.name,
            mechanism.body_name(bodies[0])
        )) {
            let (there, opposite) = row.force(back);
            // Action and reaction: at one place, and opposite, but for the rounding of a rotation.
            assert!((there - at).norm() == 0.0 && (opposite + force).norm() == 0.0);
        }
    }
    for load in &scene.loads {
        match &load.kind {
            LoadKind::Gravity { direction } => {
                let &Magnitude::Constant(size) = &load.magnitude else {
                    panic!("a constant")
                };
                for (b, mass) in scene.masses.iter().enumerate() {
                    let center = Anchor {
                        body: b,
                        point: vec![mass.center.x, mass.center.y],
                    };
                    add(
                        BodyId(b),
                        row.place(&center),
                        *direction * (size * mass.mass),
                    );
                }
            }
            LoadKind::Along(CoordinateFunction::Length { bodies, .. }, _) => {
                let (at, force) = row.force(find(&load.name).unwrap());
                add(bodies[1], at, force);
                add(bodies[0], at, -force);
            }
            LoadKind::Force { body, .. } => {
                let (at, force) = row.force(find(&load.name).unwrap());
                add(*body, at, force);
            }
            _ => {}
        }
    }
    for actuator in &mechanism.actuators {
        let couple = row.column(&format!("{}.actuator_force", actuator.name));
        sums[actuator.bodies[1].0].1 += couple;
        sums[actuator.bodies[0].0].1 -= couple;
    }
    for joint in &mechanism.joints {
        if let JointKind::Prismatic { .. } = joint.kind {
            let couple = row.column(&format!("{}.moment", joint.name));
            sums[joint.bodies[1].0].1 += couple;
            sums[joint.bodies[0].0].1 -= couple;
        }
    }
    for load in &scene.loads {
        if let LoadKind::Along(CoordinateFunction::Angle(bodies), Strength::Direct) = load.kind {
            let couple = row.column(&format!("{}.load_moment", load.name));
            sums[bodies[1].0].1 += couple;
            sums[bodies[0].0].1 -= couple;
        }
    }
    sums
}

/// Newton's and Euler's equations at rest, of every body but the ground and those that are left out.
fn balances(text: &str, contacts: &[&str], without: &[&str]) {
    let (scene, page) = statics(text);
    let drawing = page.drawing.as_ref().unwrap();
    for name in contacts {
        let mut arrows = drawing.arrows.iter();
        let arrow = arrows.find(|a| a.name == *name);
        let arrow = arrow.unwrap_or_else(|| panic!("no arrow {name}"));
        let row = |row| Row {
            page: &page,
            drawing,
            row,
        };
        let sizes = (0..ROWS).map(|k| row(k).force(arrow).1.norm());
        assert!(sizes.fold(0.0, f64::max) > 1.0, "{name} is no force");
    }
    for row in 0..ROWS {
        let row = Row {
            page: &page,
            drawing,
            row,
        };
        for (b, (force, moment)) in resultants(&scene, &row).into_iter().enumerate() {
            let name = scene.mechanism.bodies[b].name.as_str();
            if b == scene.mechanism.ground || without.contains(&name) {
                continue;
            }
            // Seen: 1.1e-13 N and 1.5e-14 N m.
            let is_small = force.norm() < 1e-11 && moment.abs() < 1e-12;
            assert!(is_small, "{name}, row {}: {force:?}, {moment}", row.row);
        }
    }
}

#[test]
fn the_forces_of_teeth_balance_those_of_the_bearings() {
    let planetary = case("planetary");
    balances(&planetary, &["inner", "outer"], &[]);
    let inner = with_angle(&planetary, "radii = [30, 20]");
    balances(
        &inner,
        &["inner", "inner.separating", "inner.line-of-action"],
        &[],
    );
    let both = with_angle(&inner, "internal = true");
    balances(
        &both,
        &["outer.line-of-action", "outer.line-of-action on ground"],
        &[],
    );
    // The ring as the second body.
    let turned = both.replace(
        "[\"ground.O\", \"planet.C\"], radii = [70, 20]",
        "[\"planet.C\", \"ground.O\"], radii = [20, 70]",
    );
    assert!(turned != both);
    balances(
        &turned,
        &["outer.separating", "outer.line-of-action on planet"],
        &[],
    );
}

#[test]
fn the_forces_of_a_rack_act_at_its_pitch_point() {
    let rack = case("rack-pinion");
    balances(&rack, &["mesh", "mesh on rack"], &[]);
    let with = with_angle(&rack, "radius = 20");
    balances(
        &with,
        &["mesh", "mesh.separating", "mesh.line-of-action"],
        &[],
    );
    // The pinion below the rack.
    let below = with
        .replace("radius = 20", "radius = -20")
        .replace("-20]", "20]");
    balances(&below, &["mesh.line-of-action"], &[]);
}

#[test]
fn a_rolling_wheel_is_held_at_its_contact() {
    balances(
        &case("rolling-wheel"),
        &["track", "track on ground", "drag"],
        &[],
    );
}

#[test]
fn a_coupling_pushes_what_follows() {
    // Its couple on the cam is no column.
    balances(&case("cam"), &["contact"], &["cam"]);
}
