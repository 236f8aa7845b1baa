//! The second reading of loads, friction and prescribed motions.

use super::expression::Expression;
use super::law::{Law, LawUnits, number};
use super::reading::{
    Friction, JointKind, Load, LoadKind, Magnitude, Measure, Reading, Source, entries, pair,
};
use super::table_curve::TableCurve;
use toml::{Table, Value};

impl Reading {
    /// Reads loads, friction and the prescribed motion; why it cannot, in words.
    pub(super) fn read_forces(&mut self, scene: &Table) -> Result<(), String> {
        for (name, table) in entries(scene, "loads") {
            let kind = self.load(table).ok_or_else(|| format!("load `{name}`"))?;
            let name = name.clone();
            self.loads.push(Load { name, kind });
        }
        for (name, table) in entries(scene, "friction") {
            for joint in 0..self.joints.len() {
                let of_pin = format!("{name}-");
                let found = &self.joints[joint].name;
                if found == name || (found.starts_with(&of_pin) && !scene_has(scene, found)) {
                    let friction = self.friction(joint, table);
                    self.frictions.push(friction);
                }
            }
        }
        let prescribed = scene.get("prescribed").and_then(Value::as_table);
        let assembly = scene.get("assembly").and_then(Value::as_table);
        for k in 0..self.actuator_count {
            let coordinate = &self.coordinates[k];
            let unit = self.unit_of(coordinate.measure);
            let start = number(assembly.and_then(|a| a.get(&coordinate.name))).unwrap_or(0.0);
            let units = LawUnits {
                value: unit,
                variable: 1.0,
                angle: self.units.angle,
            };
            let table = prescribed.and_then(|p| p.get(&coordinate.name)?.as_table());
            let law = table.and_then(|table| Law::read(table, start * unit, units));
            self.laws.push(law);
        }
        Ok(())
    }

    fn friction(&self, joint: usize, table: &Table) -> Friction {
        let of = |key: &str| number(table.get(key));
        let is_pin = self.joints[joint].kind == JointKind::Revolute;
        let (size, speed) = match is_pin {
            true => ("radius", self.units.angle),
            false => ("guide-length", self.units.length),
        };
        Friction {
            joint,
            coefficient: of("coefficient").unwrap_or(0.0),
            size: of(size).unwrap_or(0.0) * self.units.length,
            regularization_speed: of("regularization-speed").map(|v| v * speed),
            viscous: of("viscous").unwrap_or(0.0),
        }
    }

    /// A magnitude of a load or a drive.
    pub(crate) fn magnitude(&self, value: Option<&Value>) -> Option<Magnitude> {
        Some(match value? {
            Value::String(text) => Magnitude::Expression(Expression::read(text)?),
            Value::Table(table) => {
                let of = table.get("of").and_then(Value::as_str).unwrap_or("t");
                let coordinate = of.strip_suffix(".velocity").unwrap_or(of);
                let unit = self
                    .coordinate(coordinate)
                    .map_or(1.0, |c| self.unit_of(c.measure));
                let curve = TableCurve::read(table, "monotone", [unit, 1.0])?;
                Magnitude::Table {
                    of: of.to_owned(),
                    curve,
                }
            }
            other => Magnitude::Expression(Expression::Number(number(Some(other))?)),
        })
    }

    // Long: an arm for each kind of load.
    fn load(&self, table: &Table) -> Option<LoadKind> {
        let magnitude = |key: &str| self.magnitude(table.get(key));
        let given = || Some(Source::Given(magnitude("magnitude")?));
        let damper = || Some(Source::Damper(magnitude("damping")?));
        let spring = |free: &str, unit: f64| {
            Some(Source::Spring {
                stiffness: magnitude("stiffness")?,
                free: number(table.get(free))? * unit,
            })
        };
        let has = |key: &str| table.contains_key(key);
        let length = |key: &str| self.places(table.get(key)).map(Measure::Length);
        let angle = |key: &str| self.body_pair(table.get(key)).map(Measure::Angle);
        Some(if has("gravity") {
            LoadKind::Gravity(pair(table.get("gravity"))?)
        } else if has("force") {
            let [x, y] = pair(table.get("direction"))?;
            let length = x.hypot(y);
            LoadKind::Force {
                at: self.place(table.get("force")?.as_str()?)?,
                direction: [x / length, y / length],
                in_body: table.get("frame").and_then(Value::as_str) == Some("body"),
                magnitude: magnitude("magnitude")?,
            }
        } else if let Some(Value::String(body)) = table.get("torque") {
            // The first acts on the second; of one body the ground acts on it.
            let ground = self.bodies.iter().position(|b| b.is_ground)?;
            let bodies = [ground, self.body_index(body)?];
            LoadKind::Along(Measure::Angle(bodies), given()?)
        } else if has("torque") {
            LoadKind::Along(angle("torque")?, given()?)
        } else if has("point-to-point-force") {
            LoadKind::Along(length("point-to-point-force")?, given()?)
        } else if has("slide-force") {
            let (places, axis) = self.slide(table.get("slide-force")?.as_str()?)?;
            LoadKind::Along(Measure::Travel(places, axis), given()?)
        } else if has("spring") {
            let spring = spring("free-length", self.units.length)?;
            LoadKind::Along(length("spring")?, spring)
        } else if has("torsion-spring") {
            let spring = spring("free-angle", self.units.angle)?;
            LoadKind::Along(angle("torsion-spring")?, spring)
        } else if has("damper") {
            LoadKind::Along(length("damper")?, damper()?)
        } else {
            LoadKind::Along(angle("rotational-damper")?, damper()?)
        })
    }
}

fn scene_has(scene: &Table, joint: &str) -> bool {
    entries(scene, "joints").any(|(name, _)| name == joint)
}
