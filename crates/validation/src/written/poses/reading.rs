//! The second reading of a scene: bodies, joints, coordinates, loads and friction out of the plain TOML, in SI units, by a
//! reader that shares nothing with the program's own.

use super::angle_table::AngleTable;
use super::expression::Expression;
use super::law::{Law, LawUnits, number};
use super::scene_text::table_of;
use super::table_curve::TableCurve;
use super::units::Units;
use toml::{Table, Value};

/// What was read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    pub(crate) units: Units,
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: Vec<Joint>,
    /// Actuators first, then the named coordinates.
    pub(crate) coordinates: Vec<Coordinate>,
    pub(crate) actuator_count: usize,
    pub(crate) loads: Vec<Load>,
    pub(crate) frictions: Vec<Friction>,
    /// By actuator: its law of the prescribed motion.
    pub(crate) laws: Vec<Option<Law>>,
}

/// A body; the ground has no mass.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) points: Vec<(String, [f64; 2])>,
    pub(crate) mass: f64,
    pub(crate) center: [f64; 2],
    pub(crate) inertia: f64,
    /// A moment of inertia over its angle besides.
    pub(crate) varying: Option<AngleTable>,
    pub(crate) is_ground: bool,
}

impl Body {
    /// I and ½I′ at an angle, kg m².
    pub(crate) fn inertia_at(&self, angle: f64) -> [f64; 2] {
        let varying = self.varying.as_ref();
        let [inertia, half_slope] = varying.map_or([0.0; 2], |table| table.at(angle));
        [self.inertia + inertia, half_slope]
    }

    /// |I α| + |½ I′| ω², N m.
    pub(crate) fn inertia_terms(&self, [angle, omega, alpha]: [f64; 3]) -> f64 {
        let [inertia, half_slope] = self.inertia_at(angle);
        (inertia * alpha).abs() + half_slope.abs() * omega * omega
    }

    /// I α + ½ I′ ω² of an angle and its derivatives, N m.
    pub(crate) fn inertia_moment(&self, [angle, omega, alpha]: [f64; 3]) -> f64 {
        let [inertia, half_slope] = self.inertia_at(angle);
        inertia * alpha + half_slope * omega * omega
    }
}

/// A point of a body in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) body: usize,
    pub(crate) point: [f64; 2],
}

/// A joint of two bodies; one of three bodies on a pin is two of these.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) kind: JointKind,
    /// Of a coupling both are the origin of the ground.
    pub(crate) places: [Place; 2],
    /// Of teeth, rad; zero of all others.
    pub(crate) pressure_angle: f64,
}

/// The kind of a joint, lengths in m and angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum JointKind {
    Revolute,
    Prismatic {
        axes: [[f64; 2]; 2],
    },
    Slot {
        axis: [f64; 2],
    },
    Weld {
        angle: f64,
    },
    Gear {
        radii: [f64; 2],
        is_internal: bool,
    },
    Rack {
        axis: [f64; 2],
        radius: f64,
    },
    Rolling {
        axis: [f64; 2],
        radius: f64,
    },
    Distance {
        length: f64,
    },
    Coupling {
        dependent: Measure,
        independent: Measure,
        law: Law,
    },
}

/// What a coordinate measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Measure {
    /// The angle of the second body from the first.
    Angle([usize; 2]),
    /// The travel of the second place from the first along an axis of the first body.
    Travel([Place; 2], [f64; 2]),
    /// The distance of two places.
    Length([Place; 2]),
}

impl Measure {
    /// Whether it measures an angle.
    pub(crate) fn is_angle(self) -> bool {
        matches!(self, Self::Angle(_))
    }
}

/// A named coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinate {
    pub(crate) name: String,
    pub(crate) measure: Measure,
}

/// A load.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Load {
    pub(crate) name: String,
    pub(crate) kind: LoadKind,
}

/// Where a load acts, and its magnitude.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum LoadKind {
    Gravity([f64; 2]),
    Force {
        at: Place,
        direction: [f64; 2],
        in_body: bool,
        magnitude: Magnitude,
    },
    /// Along a coordinate, of its first body on its second: positive where it makes the coordinate grow.
    Along(Measure, Source),
}

/// What the force or moment along a coordinate follows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Source {
    Given(Magnitude),
    /// Stiffness, and the length or angle without a force.
    Spring {
        stiffness: Magnitude,
        free: f64,
    },
    /// By its damping.
    Damper(Magnitude),
}

/// A magnitude in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Magnitude {
    Expression(Expression),
    Table { of: String, curve: TableCurve },
}

/// Friction in a joint, by the joint's index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Friction {
    pub(crate) joint: usize,
    pub(crate) coefficient: f64,
    /// Radius of a pin, length of a guide, m.
    pub(crate) size: f64,
    /// None: by the sign of the speed.
    pub(crate) regularization_speed: Option<f64>,
    pub(crate) viscous: f64,
}

pub(super) fn pair(value: Option<&Value>) -> Option<[f64; 2]> {
    let array = value?.as_array()?;
    Some([number(array.first())?, number(array.get(1))?])
}

pub(super) fn texts(value: Option<&Value>) -> Option<Vec<&str>> {
    value?.as_array()?.iter().map(Value::as_str).collect()
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    [x / length, y / length]
}

pub(crate) fn entries<'a>(
    scene: &'a Table,
    key: &str,
) -> impl Iterator<Item = (&'a String, &'a Table)> {
    let section = scene.get(key).and_then(Value::as_table);
    section
        .into_iter()
        .flatten()
        .filter_map(|(name, value)| Some((name, value.as_table()?)))
}

impl Reading {
    /// Reads a scene; why it cannot, in words.
    pub(crate) fn new(text: &str) -> Result<Self, String> {
        let scene = table_of(text)?;
        let units = Units::read(&scene).ok_or("unknown units")?;
        let mut reading = Self {
            units,
            bodies: Vec::new(),
            joints: Vec::new(),
            coordinates: Vec::new(),
            actuator_count: 0,
            loads: Vec::new(),
            frictions: Vec::new(),
            laws: Vec::new(),
        };
        for (name, body) in entries(&scene, "bodies") {
            let body = reading.body(name, body);
            reading
                .bodies
                .push(body.ok_or_else(|| format!("body `{name}`"))?);
        }
        reading.read_joints(&scene)?;
        reading.read_forces(&scene)?;
        Ok(reading)
    }

    /// The largest distance of a point in its body, m.
    pub(crate) fn size(&self) -> f64 {
        let points = self.bodies.iter().flat_map(|body| &body.points);
        points.map(|(_, [x, y])| x.hypot(*y)).fold(0.0, f64::max)
    }

    fn body(&self, name: &str, table: &Table) -> Option<Body> {
        let length = self.units.length;
        let scaled = |p: [f64; 2]| p.map(|x| x * length);
        let mut points = Vec::new();
        for (point, value) in table.get("points")?.as_table()? {
            points.push((point.clone(), scaled(pair(Some(value))?)));
        }
        let is_ground = table
            .get("fixed")
            .and_then(Value::as_bool)
            .unwrap_or(name == "ground");
        let center = match table.get("center") {
            Some(Value::String(point)) => points.iter().find(|(p, _)| p == point)?.1,
            Some(value) => scaled(pair(Some(value))?),
            None => [0.0; 2],
        };
        let of = |key: &str| number(table.get(key)).unwrap_or(0.0);
        let share = if is_ground { 0.0 } else { 1.0 };
        Some(Body {
            name: name.to_owned(),
            mass: share * of("mass") * self.units.mass,
            inertia: share * of("inertia") * self.units.inertia,
            varying: AngleTable::read(table, &self.units).filter(|_| !is_ground),
            points,
            center,
            is_ground,
        })
    }

    pub(super) fn body_index(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|b| b.name == name)
    }

    pub(super) fn place(&self, name: &str) -> Option<Place> {
        let (body, point) = name.split_once('.')?;
        let body = self.body_index(body)?;
        let (_, point) = self.bodies[body].points.iter().find(|(p, _)| p == point)?;
        Some(Place {
            body,
            point: *point,
        })
    }

    pub(super) fn places(&self, value: Option<&Value>) -> Option<[Place; 2]> {
        let names = texts(value)?;
        Some([self.place(names.first()?)?, self.place(names.get(1)?)?])
    }

    pub(super) fn body_pair(&self, value: Option<&Value>) -> Option<[usize; 2]> {
        let names = texts(value)?;
        Some([
            self.body_index(names.first()?)?,
            self.body_index(names.get(1)?)?,
        ])
    }

    /// Places and axis of a prismatic joint or a slot.
    pub(super) fn slide(&self, name: &str) -> Option<([Place; 2], [f64; 2])> {
        let joint = self.joints.iter().find(|j| j.name == name)?;
        match joint.kind {
            JointKind::Prismatic { axes: [axis, _] } | JointKind::Slot { axis } => {
                Some((joint.places, axis))
            }
            _ => None,
        }
    }

    fn measure(&self, table: &Table) -> Option<Measure> {
        if let Some(bodies) = table.get("angle") {
            return self.body_pair(Some(bodies)).map(Measure::Angle);
        }
        let travel = table.get("travel").or(table.get("length"))?;
        if let Value::String(joint) = travel {
            let (places, axis) = self.slide(joint)?;
            return Some(Measure::Travel(places, axis));
        }
        self.places(Some(travel)).map(Measure::Length)
    }

    pub(crate) fn coordinate(&self, name: &str) -> Option<&Coordinate> {
        self.coordinates.iter().find(|c| c.name == name)
    }

    /// The coordinates that are driven.
    pub(crate) fn actuators(&self) -> &[Coordinate] {
        &self.coordinates[..self.actuator_count]
    }

    /// The unit of a coordinate in the scene, in SI units.
    pub(crate) fn unit_of(&self, measure: Measure) -> f64 {
        match measure.is_angle() {
            true => self.units.angle,
            false => self.units.length,
        }
    }

    fn read_joints(&mut self, scene: &Table) -> Result<(), String> {
        let mut couplings = Vec::new();
        for (name, table) in entries(scene, "joints") {
            if table.contains_key("coupling") {
                couplings.push((name, table));
                continue;
            }
            let joints = self.joint(name, table);
            self.joints
                .extend(joints.ok_or_else(|| format!("joint `{name}`"))?);
        }
        for section in ["actuators", "coordinates"] {
            for (name, table) in entries(scene, section) {
                let measure = self
                    .measure(table)
                    .ok_or_else(|| format!("coordinate `{name}`"))?;
                let name = name.clone();
                self.coordinates.push(Coordinate { name, measure });
            }
            if section == "actuators" {
                self.actuator_count = self.coordinates.len();
            }
        }
        for (name, table) in couplings {
            let kind = self
                .coupling(table)
                .ok_or_else(|| format!("coupling `{name}`"))?;
            let places = [Place {
                body: 0,
                point: [0.0; 2],
            }; 2];
            self.joints.push(Joint {
                name: name.clone(),
                kind,
                places,
                pressure_angle: 0.0,
            });
        }
        Ok(())
    }

    fn coupling(&self, table: &Table) -> Option<JointKind> {
        let names = texts(table.get("coupling"))?;
        let of = |k: usize| Some(self.coordinate(names.get(k)?)?.measure);
        let (dependent, independent) = (of(0)?, of(1)?);
        let units = LawUnits {
            value: self.unit_of(dependent),
            variable: self.unit_of(independent),
            angle: self.units.angle,
        };
        let start = number(table.get("start")).unwrap_or(0.0) * units.value;
        let law = Law::read(table, start, units)?;
        Some(JointKind::Coupling {
            dependent,
            independent,
            law,
        })
    }

    // Long: an arm for each kind of joint.
    fn joint(&self, name: &str, table: &Table) -> Option<Vec<Joint>> {
        let kinds = [
            "revolute",
            "prismatic",
            "slot",
            "weld",
            "gear",
            "rack",
            "rolling",
            "distance",
        ];
        let key = kinds.into_iter().find(|kind| table.contains_key(*kind))?;
        let names = texts(table.get(key))?;
        let places: Vec<Place> = names.iter().map(|n| self.place(n)).collect::<Option<_>>()?;
        let length = |key: &str| Some(number(table.get(key))? * self.units.length);
        let angle = |key: &str| number(table.get(key)).unwrap_or(0.0) * self.units.angle;
        let axis = || pair(table.get("axis")).map(unit);
        let kind = match key {
            "revolute" => JointKind::Revolute,
            "prismatic" => JointKind::Prismatic {
                axes: match table.get("axes").and_then(Value::as_array) {
                    Some(axes) => [unit(pair(axes.first())?), unit(pair(axes.get(1))?)],
                    None => [axis()?; 2],
                },
            },
            "slot" => JointKind::Slot { axis: axis()? },
            "weld" => JointKind::Weld {
                angle: angle("angle"),
            },
            "gear" => JointKind::Gear {
                radii: pair(table.get("radii"))?.map(|r| r * self.units.length),
                is_internal: table
                    .get("internal")
                    .and_then(Value::as_bool)
                    .unwrap_or(false),
            },
            "rack" => JointKind::Rack {
                axis: axis()?,
                radius: length("radius")?,
            },
            "rolling" => JointKind::Rolling {
                axis: axis()?,
                radius: length("radius")?,
            },
            _ => JointKind::Distance {
                length: length("length")?,
            },
        };
        let several = places.len() > 2;
        let joint = |second: &Place| Joint {
            name: match several {
                true => format!("{name}-{}", self.bodies[second.body].name),
                false => name.to_owned(),
            },
            kind: kind.clone(),
            places: [places[0], *second],
            pressure_angle: angle("pressure-angle"),
        };
        (places.len() >= 2).then(|| places[1..].iter().map(joint).collect())
    }
}
