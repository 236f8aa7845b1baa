//! Reads a reference as a mechanism in space.

use dwell_geometry::space::{
    Actuator, Assembly, Joint, JointKind, Mechanism, Placement, Plan, Pose, Rotation, Side, Vec3,
    vec3,
};
use dwell_geometry::{Body, BodyId, JointId};
use dwell_kinetostatics::space::{Axes, Component, Mass, Model, Reaction};
use dwell_laws::Expression;
use serde_json::Value;

/// A number, or an exact expression.
pub(crate) fn number(value: &Value) -> f64 {
    match value {
        Value::Number(n) => n.as_f64().expect("a number"),
        Value::String(text) => text.parse().unwrap_or_else(|_| {
            let text = text.replace("**", "^");
            Expression::parse(&text, &[])
                .unwrap_or_else(|e| panic!("{text}: {e}"))
                .eval(&[])
        }),
        other => panic!("no number: {other}"),
    }
}

/// Three numbers.
pub(crate) fn vector(value: &Value) -> Vec3 {
    let n = |k: usize| number(&value[k]);
    vec3(n(0), n(1), n(2))
}

fn rotation(value: &Value) -> Rotation {
    let row = |k: usize| [0, 1, 2].map(|j| number(&value[k][j]));
    Rotation::of_rows([row(0), row(1), row(2)]).expect("a rotation")
}

/// One reference.
pub(crate) struct Reference {
    pub(crate) name: String,
    pub(crate) data: Value,
    bodies: Vec<String>,
}

impl Reference {
    pub(crate) fn read(name: &str) -> Self {
        let path = format!(
            "{}/../validation/spatial/{name}.json",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = std::fs::read_to_string(path).expect("the file");
        let data: Value = serde_json::from_str(&text).expect("JSON");
        let mut bodies = vec!["ground".to_owned()];
        bodies.extend(
            data["definition"]["bodies"]
                .as_object()
                .expect("bodies")
                .keys()
                .cloned(),
        );
        Self {
            name: name.to_owned(),
            data,
            bodies,
        }
    }

    pub(crate) fn samples(&self) -> &[Value] {
        self.data["samples"].as_array().expect("samples")
    }

    pub(crate) fn gravity(&self) -> Option<Vec3> {
        self.data["definition"].get("gravity").map(vector)
    }

    /// The largest value of this name in the samples.
    pub(crate) fn scale_of(&self, name: &str) -> f64 {
        let values = self
            .samples()
            .iter()
            .map(|s| number(&s[name]["gravity"]).abs());
        values.fold(0.0, f64::max)
    }

    fn body(&self, value: &Value) -> usize {
        self.bodies
            .iter()
            .position(|b| b == value.as_str().expect("a name"))
            .expect("a body")
    }

    pub(crate) fn mechanism(&self) -> Mechanism {
        let definition = &self.data["definition"];
        let driver = &definition["driver"];
        let mut driven = Vec::new();
        let mut joints = Vec::new();
        let all = definition["joints"].as_array().expect("joints");
        let fixed = definition["fixed_drivers"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        for (j, joint) in all.iter().enumerate() {
            let bodies = [self.body(&joint["a"]), self.body(&joint["b"])];
            let drives = |d: &&Value| [self.body(&d["a"]), self.body(&d["b"])] == bodies;
            let by = fixed.iter().chain([driver]).find(drives);
            let side = |p: &str, u: &str, n: &str| {
                let get = |key: &str| joint.get(key).map(vector);
                let normal = by.and_then(|d| d.get(n)).map(vector).or_else(|| get(n));
                let side = Side {
                    point: get(p).unwrap_or(Vec3::ZERO),
                    ..Side::default()
                };
                let axis = get(u).unwrap_or(side.axis);
                let parallel = axis.cross(side.normal).norm() == 0.0;
                let any = if parallel {
                    vec3(0.0, 1.0, 0.0)
                } else {
                    side.normal
                };
                Side {
                    axis,
                    normal: normal.unwrap_or(any),
                    ..side
                }
            };
            let kind = match joint["kind"].as_str().expect("a kind") {
                "revolute" => JointKind::Revolute,
                "prismatic" => JointKind::Prismatic,
                "cylindrical" => JointKind::Cylindrical,
                "universal" => JointKind::Universal,
                "spherical" => JointKind::Spherical,
                "distance" => JointKind::Distance {
                    length: number(&joint["length"]),
                },
                other => panic!("{other}"),
            };
            if by.is_some() && kind == JointKind::Revolute {
                driven.push((j, by == Some(driver)));
            }
            let mut sides = [side("pa", "ua", "na"), side("pb", "ub", "nb")];
            // The references' axes are parallel in either sense.
            let placed = self.assembly(&[]).placements;
            let axis = |k: usize| placed[bodies[k]].rotation.apply(sides[k].axis);
            if kind != JointKind::Universal && axis(0).dot(axis(1)) < 0.0 {
                sides[1].axis = -sides[1].axis;
            }
            joints.push(Joint::new(
                joint["name"].as_str().expect("a name"),
                bodies,
                kind,
                sides,
            ));
        }
        driven.sort_by_key(|(_, main)| !main);
        Mechanism {
            bodies: self.bodies.iter().map(Body::named).collect(),
            ground: 0,
            joints,
            actuators: driven
                .iter()
                .map(|(j, _)| Actuator::angle("q", *j))
                .collect(),
            couplings: Vec::new(),
        }
    }

    pub(crate) fn masses(&self) -> Vec<Mass> {
        let of = |body: &String| {
            let Some(body) = self.data["definition"]["bodies"].get(body) else {
                return Mass::default();
            };
            let mut inertia = [0.0; 6];
            for (to, from) in inertia
                .iter_mut()
                .zip(body["inertia"].as_array().expect("inertia"))
            {
                *to = number(from);
            }
            Mass {
                mass: number(&body["mass"]),
                center: vector(&body["com"]),
                inertia,
            }
        };
        self.bodies.iter().map(of).collect()
    }

    pub(crate) fn assembly(&self, q: &[f64]) -> Assembly {
        let of = |body: &String| match self.data["assembly"].get(body) {
            Some(placed) => Placement {
                position: vector(&placed["position"]),
                rotation: rotation(&placed["rotation_rows"]),
            },
            None => Placement::default(),
        };
        Assembly {
            q: q.to_vec(),
            placements: self.bodies.iter().map(of).collect(),
        }
    }

    /// The model with all components of all joints in ground axes, and their names.
    pub(crate) fn model(&self) -> (Model, Vec<(String, Reaction)>) {
        self.model_at(&[number(&self.data["assembly"]["at_q"])])
    }

    /// The same, assembled at these coordinates.
    pub(crate) fn model_at(&self, q: &[f64]) -> (Model, Vec<(String, Reaction)>) {
        let mechanism = self.mechanism();
        let mut names = Vec::new();
        for (j, joint) in mechanism.joints.iter().enumerate() {
            for (k, axis) in ["x", "y", "z"].iter().enumerate() {
                for (letter, component) in [
                    ("F", Component::Force(Axes::Ground, k)),
                    ("M", Component::Moment(Axes::Ground, k)),
                ] {
                    let reaction = Reaction {
                        joint: JointId(j),
                        component,
                    };
                    names.push((format!("{}.{letter}{axis}", joint.name), reaction));
                }
            }
        }
        let reactions: Vec<Reaction> = names.iter().map(|(_, r)| *r).collect();
        let model = Model::new(&mechanism, &self.masses(), &self.assembly(q), &reactions);
        (
            model.unwrap_or_else(|e| panic!("{}: {e:?}", self.name)),
            names,
        )
    }

    /// The largest differences of positions, velocities and accelerations, in parts of the mechanism's size and rad.
    pub(crate) fn motion_differences(
        &self,
        plan: &Plan,
        pose: &Pose<f64>,
        sample: &Value,
    ) -> [f64; 3] {
        let mut found = [0.0_f64; 3];
        let mobility = plan.mobility();
        let size = plan.size();
        for (b, name) in self.bodies.iter().enumerate().skip(1) {
            let want = &sample["bodies"][name];
            if want.is_null() {
                continue;
            }
            let (placed, motion) = (plan.placement(pose, b), plan.body_motion(pose, b));
            let turned = rotation(&want["rotation_rows"]);
            let idle = mobility.idle.iter().find(|i| i.body == BodyId(b));
            // Of a body that turns idly, its line is compared: how it stands about it is nobody's.
            let turn = idle.map_or_else(
                || turned.inverse().after(&placed.rotation).vector(),
                |i| turned.apply(i.axis) - placed.rotation.apply(i.axis),
            );
            let point = idle.map_or(Vec3::ZERO, |i| i.point);
            let differ =
                |got: Vec3, want: Vec3, unit: f64| (got - want).norm() / (unit + want.norm());
            let wanted = |key: &str| vector(&want[key]);
            let at = |r: &Rotation, origin: Vec3| origin + r.apply(point);
            let position = differ(
                at(&placed.rotation, placed.position),
                at(&turned, wanted("position")),
                size,
            );
            found[0] = found[0].max(turn.norm()).max(position);
            if point.norm() < 1e-12 * size {
                found[1] = found[1].max(differ(motion.velocity, wanted("v"), size));
                found[2] = found[2].max(differ(motion.acceleration, wanted("vdot"), size));
            }
            found[1] = found[1].max(differ(motion.angular_velocity, wanted("omega"), 1.0));
            found[2] = found[2].max(differ(motion.angular_acceleration, wanted("omegadot"), 1.0));
        }
        found
    }
}
