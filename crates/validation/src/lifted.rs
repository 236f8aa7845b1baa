//! Planar scenes placed obliquely in space: the same mechanism, with each joint at its own height above the plane.

use dwell_geometry::space::{
    Actuator, Assembly, Coordinate, CouplingAction, Joint, JointKind, Mechanism, Placement,
    Rotation, Side, Vec3, vec3,
};
use dwell_geometry::{self as plane, ActuatorKind, BodyId, Coupling, JointId, Vec2};
use dwell_kinetostatics::Model;
use dwell_kinetostatics::space::Mass;
use dwell_scene::PlaneScene;

/// The plane's frame in space.
pub fn tilt() -> Placement {
    Placement {
        position: vec3(0.7, -0.3, 1.1),
        rotation: Rotation::of_vector(vec3(0.9, -1.3, 0.4)),
    }
}

/// How much higher the second point of every second distance is than the first, m.
const RISE: f64 = 0.3;

/// The rise of a distance by the number of its joint, m.
fn rise(joint: usize) -> f64 {
    RISE * (joint % 2) as f64
}

/// A planar mechanism in space.
#[derive(Debug, Clone)]
pub struct Lifted {
    /// Bodies, joints and the actuator, in the order of the plane.
    pub mechanism: Mechanism,
    /// By body.
    pub masses: Vec<Mass>,
    /// Its assembly.
    pub assembly: Assembly,
}

/// The plane of a mechanism, and the height of each joint above it, m.
pub struct Plane<'a> {
    /// Its frame in that of the scene.
    pub frame: Placement,
    /// By joint.
    pub heights: &'a dyn Fn(usize) -> f64,
}

impl Plane<'_> {
    fn lifted(&self, v: Vec2, height: f64) -> Vec3 {
        vec3(v.x, v.y, height)
    }

    /// A joint in space with its axes in or across the plane; none of a kind that has no counterpart.
    fn joint(&self, j: usize, joint: &plane::Joint, ground: usize) -> Option<Joint> {
        let (z, x) = (vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0));
        let (kind, directions) = match joint.kind {
            plane::JointKind::Revolute => (JointKind::Revolute, [[z, x]; 2]),
            plane::JointKind::Prismatic { axes } => {
                // Its normals are oblique to the plane.
                let along = axes.map(|axis| {
                    let axis = self.lifted(axis, 0.0);
                    [axis, z.scaled(0.8) + axis.cross(z).scaled(0.6)]
                });
                (JointKind::Prismatic, along)
            }
            plane::JointKind::Distance { length } => {
                let length = length.hypot(rise(j));
                (JointKind::Distance { length }, [[z, x]; 2])
            }
            plane::JointKind::Weld { angle } => {
                // The second body's frame is turned, so that the first's x has this direction in it.
                let (sin, cos) = angle.sin_cos();
                (JointKind::Weld, [[z, x], [z, vec3(cos, -sin, 0.0)]])
            }
            _ => return None,
        };
        let side = |k: usize| {
            let [axis, normal] = directions[k];
            let is_distance = matches!(kind, JointKind::Distance { .. });
            let rise = if k == 1 && is_distance { rise(j) } else { 0.0 };
            let point = self.lifted(joint.points[k], (self.heights)(j) + rise);
            // The ground's frame is that of the scene: what is on the ground is tilted.
            let frame = if joint.bodies[k].0 == ground {
                self.frame
            } else {
                Placement::default()
            };
            Side {
                point: frame.position + frame.rotation.apply(point),
                axis: frame.rotation.apply(axis),
                normal: frame.rotation.apply(normal),
            }
        };
        let sides = [side(0), side(1)];
        Some(Joint::new(joint.name.clone(), joint.bodies, kind, sides))
    }

    /// A coordinate in space; `None` of an angle between bodies that no hinge connects in this order.
    fn coordinate(&self, of: plane::Coordinate, planar: &plane::Mechanism) -> Option<Coordinate> {
        let is_hinge = |joint: &plane::Joint| matches!(joint.kind, plane::JointKind::Revolute);
        let mut joints = planar.joints.iter();
        match of {
            plane::Coordinate::Angle(bodies) => {
                let hinge = joints.position(|j| is_hinge(j) && j.bodies == bodies)?;
                Some(Coordinate::Angle(JointId(hinge)))
            }
            plane::Coordinate::Travel(joint) => {
                let kind = planar.joints[joint.0].kind;
                let slides = matches!(kind, plane::JointKind::Prismatic { .. });
                slides.then_some(Coordinate::Travel(joint))
            }
            plane::Coordinate::Length { bodies, points } => {
                let point = |k: usize| {
                    let point = self.lifted(points[k], 0.0);
                    if bodies[k].0 == planar.ground {
                        self.frame.point(point)
                    } else {
                        point
                    }
                };
                let points = [point(0), point(1)];
                Some(Coordinate::Distance { bodies, points })
            }
        }
    }

    /// The joint of a coupling, with the sides of its dependent coordinate.
    fn coupling_joint(
        &self,
        index: usize,
        joint: &plane::Joint,
        planar: &plane::Mechanism,
    ) -> Option<Joint> {
        let of = self.coordinate(planar.couplings[index].dependent, planar)?;
        let of_joint = |id: JointId| self.joint(id.0, &planar.joints[id.0], planar.ground);
        let (action, bodies, sides) = match of {
            Coordinate::Angle(id) => {
                let joint = of_joint(id)?;
                (CouplingAction::Couple, joint.bodies, joint.sides)
            }
            Coordinate::Travel(id) => {
                let joint = of_joint(id)?;
                (CouplingAction::Force, joint.bodies, joint.sides)
            }
            Coordinate::Distance { bodies, points } => {
                let side = |point| Side {
                    point,
                    ..Side::default()
                };
                (CouplingAction::Line, bodies, points.map(side))
            }
        };
        let kind = JointKind::Coupling { index, action };
        Some(Joint::new(joint.name.clone(), bodies, kind, sides))
    }

    /// The mechanism in space; `None` if a joint or the actuator has no counterpart.
    fn mechanism(&self, planar: &plane::Mechanism) -> Option<Mechanism> {
        let joints = planar.joints.iter().enumerate();
        let joints: Option<Vec<Joint>> = joints
            .map(|(j, joint)| match joint.kind {
                plane::JointKind::Coupling(index) => self.coupling_joint(index, joint, planar),
                _ => self.joint(j, joint, planar.ground),
            })
            .collect();
        let couplings = planar.couplings.iter().map(|of| {
            Some(Coupling {
                dependent: self.coordinate(of.dependent, planar)?,
                independent: self.coordinate(of.independent, planar)?,
                law: of.law.clone(),
            })
        });
        let [actuator] = &planar.actuators[..] else {
            return None;
        };
        let driven = match actuator.kind {
            ActuatorKind::Angle => planar.joints.iter().position(|j| {
                j.bodies == actuator.bodies && matches!(j.kind, plane::JointKind::Revolute)
            })?,
            ActuatorKind::Travel(joint) => joint.0,
            ActuatorKind::Length(_) => return None,
        };
        let name = actuator.name.clone();
        let actuator = match actuator.kind {
            ActuatorKind::Travel(_) => Actuator::travel(name, driven),
            _ => Actuator::angle(name, driven),
        };
        Some(Mechanism {
            bodies: planar.bodies.clone(),
            ground: planar.ground,
            joints: joints?,
            actuators: vec![actuator],
            couplings: couplings.collect::<Option<Vec<_>>>()?,
        })
    }

    /// The placements in space of the bodies of a planar model at a coordinate.
    fn placements(&self, model: &Model, q: f64) -> Option<Vec<Placement>> {
        let mut workspace = model.workspace();
        let mut state = model.kinematic_state(&[q], &[1.0], &mut workspace).ok()?;
        let states = state.bodies_at(&[0.0]);
        let place = |b: usize| {
            if b == model.mechanism().ground {
                return Placement::default();
            }
            let rotation = states.body(BodyId(b)).rotation;
            let at = states.point(BodyId(b), Vec2::ZERO).position;
            let turn = Rotation::of_vector(vec3(0.0, 0.0, rotation.y.atan2(rotation.x)));
            Placement {
                position: self.frame.position + self.frame.rotation.apply(self.lifted(at, 0.0)),
                rotation: self.frame.rotation.after(&turn),
            }
        };
        Some((0..model.mechanism().bodies.len()).map(place).collect())
    }

    /// A planar model in space; `None` if a joint or the actuator has no counterpart.
    pub fn lift(&self, model: &Model, masses: &[dwell_kinetostatics::Mass]) -> Option<Lifted> {
        let mechanism = self.mechanism(model.mechanism())?;
        let start = model.plan().assembly_coordinates()[0];
        // What a mass is above the plane does not matter to m.
        let masses = masses.iter().enumerate().map(|(b, m)| Mass {
            mass: m.mass,
            center: self.lifted(m.center, (self.heights)(b)),
            inertia: [1.3, 1.2, 1.0, 0.05, 0.1, -0.07].map(|part| part * m.inertia),
        });
        Some(Lifted {
            masses: masses.collect(),
            assembly: Assembly {
                q: vec![start],
                placements: self.placements(model, start)?,
            },
            mechanism,
        })
    }
}

/// A planar scene obliquely in space, with its model; `None` if a joint or the actuator has no counterpart, or an inertia varies.
pub fn lifted_scene(scene: &PlaneScene) -> Option<(Model, Lifted)> {
    if !scene.varying_inertias.is_empty() {
        return None;
    }
    let start = scene.assembly.to_configuration();
    let planar = Model::new(&scene.mechanism, &scene.masses, &start, &[]).ok()?;
    let plane = Plane {
        frame: tilt(),
        heights: &|j| 0.04 * j as f64,
    };
    let lifted = plane.lift(&planar, &scene.masses)?;
    Some((planar, lifted))
}
