//! Numbers that probably have a wrong unit, because they are far from those of any machine. Each criterion leaves several powers of
//! ten to real machines and is silent for every case. The results are warnings of the scene, which every command shows.

use crate::dimensions::{Dimensions, Plane, Space};
use crate::error::SceneWarning;
use crate::file::SceneFile;
use crate::scene_data::{PlaneScene, SceneIn, SpaceScene};
use crate::spans::SceneLocation;
use crate::wording::{list, short, shorten};
use dwell_geometry::{ActuatorId, BodyId};
use dwell_kinetostatics::{LoadShape as _, Magnitude};
use std::f64::consts::TAU;

/// Acceleration of free fall, m/s², and how much another may differ to be a thousand times it: a hundredth.
const FREE_FALL: f64 = 9.81;
const SAME: f64 = 0.01;
/// Revolutions of an angle at the start that is given in radians: 30 is nearly five.
const REVOLUTIONS: f64 = 3.0;
/// Least and largest mass over the cube of a mechanism's size, kg/m³: a boom of 30 m and 100 kg has 4e-3, solid steel
/// 8e3. There are no warnings below and above certain sizes (m).
const DENSITIES: [f64; 2] = [1e-4, 1e7];
const LARGE: f64 = 30.0;
const SMALL: f64 = 0.01;
/// Bounds of plausible radii of gyration: largest and least multiple of the size of the mechanism (0.02 to 1.9 in all cases), and
/// least multiple of the size of the body (0.02 to 14 in all cases). An inertia that is wrong by a factor of a million changes them
/// by a thousand.
const WIDEST: f64 = 20.0;
const NARROWEST: [f64; 2] = [2e-4, 2e-3];
/// Typical radius of gyration of a body relative to its size, and the factor within which an inertia in another unit is
/// plausible.
const USUAL: f64 = 0.3;
const NEAR: f64 = 100.0;
/// Possible units of an inertia, in SI.
const INERTIAS: [(&str, f64); 4] = [
    ("kg m2", 1.0),
    ("kg cm2", 1e-4),
    ("kg mm2", 1e-6),
    ("g mm2", 1e-9),
];

/// The examined numbers of a scene, in the plane or in space.
pub(crate) struct Figures<'s> {
    file: &'s SceneFile,
    /// Largest distance of two joints on a body, m.
    size: f64,
    bodies: Vec<BodyFigures<'s>>,
    /// The constant magnitudes of gravity, m/s², by the numbers of their loads.
    gravities: Vec<(usize, f64)>,
    /// Angles at the start, rad, with their places and names.
    angles: Vec<(SceneLocation, &'s str, f64)>,
}

struct BodyFigures<'s> {
    id: BodyId,
    name: &'s str,
    mass: f64,
    /// The largest moment of inertia, kg m².
    inertia: f64,
    /// Diagonal of the box around its points and its centre of mass, m.
    size: f64,
    /// Whether a joint connects it with the ground.
    is_held: bool,
}

/// Scenes whose numbers are examined.
pub(crate) trait Doubtful: Dimensions {
    /// The examined numbers of a scene.
    fn figures(scene: &SceneIn<Self>) -> Figures<'_>;

    /// The scene with a warning for each number that looks like a slip of units.
    fn with_doubts(mut scene: SceneIn<Self>) -> SceneIn<Self> {
        let warnings = Self::figures(&scene).warnings();
        scene.file.warnings.extend(warnings);
        scene
    }
}

impl Doubtful for Plane {
    fn figures(scene: &PlaneScene) -> Figures<'_> {
        let mechanism = &scene.mechanism;
        let names = mechanism.bodies.iter().map(|body| body.name.as_str());
        let joints = mechanism.joints.iter().map(|joint| joint.bodies);
        let body = |b: usize| {
            let (mass, points) = (&scene.masses[b], scene.points[b].iter());
            let [x, y] = [mass.center.x, mass.center.y];
            let points = points.map(|(_, p)| [p.x, p.y, 0.0]).collect();
            ([mass.mass, mass.inertia], [x, y, 0.0], points)
        };
        let gravities = scene
            .loads
            .iter()
            .map(|load| (load.kind.is_gravity(), &load.magnitude));
        let guesses = scene.assembly.initial_guess.iter().enumerate();
        let of_bodies = guesses.filter_map(|(b, angle)| {
            let location = SceneLocation::InitialGuess(BodyId(b));
            Some((location, mechanism.bodies[b].name.as_str(), (*angle)?))
        });
        let actuators = mechanism.actuators.iter();
        let actuators = actuators.map(|a| (a.name.as_str(), a.coordinate().is_angle()));
        Figures {
            file: &scene.file,
            size: mechanism.size(),
            bodies: body_figures(names, BodyId(mechanism.ground), joints, body),
            gravities: constant(gravities),
            angles: of_bodies
                .chain(starting_angles(actuators, &scene.assembly.coordinates))
                .collect(),
        }
    }
}

impl Doubtful for Space {
    fn figures(scene: &SpaceScene) -> Figures<'_> {
        let mechanism = &scene.mechanism;
        let names = mechanism.bodies.iter().map(|body| body.name.as_str());
        let joints = mechanism.joints.iter().map(|joint| joint.bodies);
        let body = |b: usize| {
            let (mass, points) = (&scene.masses[b], scene.points[b].iter());
            let largest = mass.inertia[..3].iter().copied().fold(0.0, f64::max);
            let points = points.map(|(_, p)| [p.x, p.y, p.z]).collect();
            let center = [mass.center.x, mass.center.y, mass.center.z];
            ([mass.mass, largest], center, points)
        };
        let gravities = scene
            .loads
            .iter()
            .map(|load| (load.kind.is_gravity(), &load.magnitude));
        let actuators = mechanism.actuators.iter().map(|actuator| {
            let joint = &mechanism.joints[actuator.kind.joint().0];
            let is_angle = actuator.kind.coordinate(joint).is_angle();
            (actuator.name.as_str(), is_angle)
        });
        Figures {
            file: &scene.file,
            size: mechanism.size(),
            bodies: body_figures(names, BodyId(mechanism.ground), joints, body),
            gravities: constant(gravities),
            angles: starting_angles(actuators, &scene.assembly.q).collect(),
        }
    }
}

/// The bodies without the ground; `of` returns mass and inertia, centre of mass and points of one.
fn body_figures<'s>(
    names: impl Iterator<Item = &'s str>,
    ground: BodyId,
    joints: impl Iterator<Item = [BodyId; 2]>,
    of: impl Fn(usize) -> ([f64; 2], [f64; 3], Vec<[f64; 3]>),
) -> Vec<BodyFigures<'s>> {
    let held = joints.filter(|pair| pair.contains(&ground)).flatten();
    let held: Vec<BodyId> = held.collect();
    let moving = names.enumerate().map(|(b, name)| (BodyId(b), name));
    let one = |(id, name): (BodyId, &'s str)| {
        let ([mass, inertia], center, points) = of(id.0);
        let center = (mass > 0.0).then_some(center);
        BodyFigures {
            id,
            name,
            mass,
            inertia,
            size: diagonal(points.into_iter().chain(center)),
            is_held: held.contains(&id),
        }
    };
    moving.filter(|(id, _)| *id != ground).map(one).collect()
}

/// Diagonal of the box around some points, m.
fn diagonal(points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [low, high] = points.fold(empty, |[mut low, mut high], point| {
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
        [low, high]
    });
    let sides = low
        .iter()
        .zip(high)
        .map(|(low, high)| (high - low).max(0.0));
    sides.map(|side| side * side).sum::<f64>().sqrt()
}

/// The constant magnitudes of loads that are gravity, with the numbers of the loads.
fn constant<'m, C: 'm>(loads: impl Iterator<Item = (bool, &'m Magnitude<C>)>) -> Vec<(usize, f64)> {
    let one = |(k, (is_gravity, magnitude)): (usize, (bool, &Magnitude<C>))| match magnitude {
        Magnitude::Constant(value) if is_gravity => Some((k, *value)),
        _ => None,
    };
    loads.enumerate().filter_map(one).collect()
}

/// The coordinates of actuators that are angles.
fn starting_angles<'s>(
    actuators: impl Iterator<Item = (&'s str, bool)>,
    coordinates: &[f64],
) -> impl Iterator<Item = (SceneLocation, &'s str, f64)> {
    let one = |(a, ((name, is_angle), q)): (usize, ((&'s str, bool), &f64))| {
        is_angle.then_some((SceneLocation::AssemblyCoordinate(ActuatorId(a)), name, *q))
    };
    actuators.zip(coordinates).enumerate().filter_map(one)
}

impl Figures<'_> {
    fn warnings(&self) -> Vec<SceneWarning> {
        let gravities = self.gravities.iter();
        let mut all: Vec<SceneWarning> = gravities
            .filter_map(|&(k, value)| self.gravity(k, value))
            .collect();
        let angles = self.angles.iter();
        all.extend(angles.filter_map(|&(at, name, angle)| self.angle(at, name, angle)));
        match self.size() {
            // Lengths in another unit make every inertia look wrong, too.
            Some(size) => all.push(size),
            None => all.extend(
                [false, true]
                    .iter()
                    .filter_map(|large| self.inertias(*large)),
            ),
        }
        let bodies = self.bodies.iter();
        all.extend(bodies.filter_map(|body| self.without_mass(body)));
        all
    }

    fn warning(&self, message: String, label: &str, at: SceneLocation) -> SceneWarning {
        SceneWarning::at(&self.file.source, message, label, self.file.span(at))
    }

    /// Warns of a gravity such as 9810 m/s², which is probably in mm/s².
    fn gravity(&self, load: usize, value: f64) -> Option<SceneWarning> {
        let is = |factor: f64| (value.abs() / (factor * FREE_FALL) - 1.0).abs() < SAME;
        let message = format!(
            "is a unit meant otherwise? gravity is in m/s²: {} m/s², not {FREE_FALL}",
            short(value.abs())
        );
        let at = SceneLocation::Load(load);
        (is(1e3) || is(1e-3)).then(|| self.warning(message, "an acceleration of gravity", at))
    }

    /// An angle at the start of many revolutions in radians: meant in degrees.
    fn angle(&self, at: SceneLocation, name: &str, angle: f64) -> Option<SceneWarning> {
        let is_suspicious =
            self.file.to_scene_unit(1.0, true).0 == 1.0 && angle.abs() > REVOLUTIONS * TAU;
        let message = format!(
            "is a unit meant otherwise? `{}` is at {} rad at the start, {} revolutions; [units] angle = \"deg\" gives degrees",
            shorten(name),
            short(angle),
            short(angle / TAU)
        );
        is_suspicious.then(|| self.warning(message, "an angle in rad", at))
    }

    /// A size that the masses contradict: metres for millimetres, or the reverse.
    fn size(&self) -> Option<SceneWarning> {
        let heaviest = self.bodies.iter().map(|body| body.mass).fold(0.0, f64::max);
        let density = heaviest / self.size.powi(3);
        let [least, most] = DENSITIES;
        let is_large = self.size > LARGE && density < least;
        let is_small = self.size > 0.0 && self.size < SMALL && density > most;
        if heaviest == 0.0 || !(is_large || is_small) {
            return None;
        }
        let (size, unit) = self.file.to_scene_unit(self.size, false);
        let meant = if is_large { "mm" } else { "m" };
        let message = format!(
            "is a unit meant otherwise? links are up to {} {unit} long, and the heaviest body has {} kg; [units] length = \"{meant}\" gives {meant}",
            short(size),
            short(heaviest)
        );
        Some(self.warning(message, "the unit of length", SceneLocation::Units))
    }

    /// Inertias that no body of its mass and size has: one warning for all bodies.
    fn inertias(&self, is_large: bool) -> Option<SceneWarning> {
        let is_suspicious = |body: &&BodyFigures<'_>| {
            let radius = body.radius_of_gyration();
            let size = self.size.max(body.size);
            let narrowest = (NARROWEST[0] * size).max(NARROWEST[1] * body.size);
            if is_large {
                size > 0.0 && radius > WIDEST * size
            } else {
                radius > 0.0 && radius < narrowest
            }
        };
        let suspicious = || self.bodies.iter().filter(is_suspicious);
        let body = suspicious().next()?;
        let names = list(suspicious().map(|body| body.name)).unwrap_or_default();
        let size = self.size.max(body.size);
        let (radius, unit) = self.file.to_scene_unit(body.radius_of_gyration(), false);
        let (what, extent) = if body.size > 0.0 {
            ("its points are within", body.size)
        } else {
            ("links are up to", size)
        };
        let message = format!(
            "is a unit meant otherwise? By its inertia and mass `{}` has a radius of gyration of {} {unit}, but {what} {} {unit}: {} Check {names}",
            shorten(body.name),
            short(radius),
            short(self.file.to_scene_unit(extent, false).0),
            self.meant(body, size),
        );
        Some(self.warning(message, "an inertia", SceneLocation::Inertia(body.id)))
    }

    /// A text on the unit in which an inertia was read, and on the probable one: its own unit, or that of the lengths.
    fn meant(&self, body: &BodyFigures<'_>, size: f64) -> String {
        let (inertia, length) = (&self.file.units.inertia, &self.file.units.length);
        let usual = body.mass * (USUAL * size).powi(2);
        let written = inertia.to_scene_unit(body.inertia);
        let misfit = |factor: f64| (written * factor / usual).ln().abs();
        let nearest = INERTIAS
            .iter()
            .min_by(|a, b| misfit(a.1).total_cmp(&misfit(b.1)));
        let guess = match (nearest, body.inertia > usual) {
            (Some((name, factor)), _) if misfit(*factor) < NEAR.ln() => {
                format!("was the inertia meant in {name}?")
            }
            (_, true) => "were the lengths meant in a larger unit, such as m?".to_owned(),
            (_, false) => "were the lengths meant in a smaller unit, such as mm?".to_owned(),
        };
        let [inertia, length] = [&inertia.name, &length.name];
        format!("the inertia is read in {inertia}, lengths in {length}; {guess}")
    }

    /// A centre of mass without a mass, or an inertia where the missing mass has an effect.
    fn without_mass(&self, body: &BodyFigures<'_>) -> Option<SceneWarning> {
        let gives = |at: SceneLocation| self.file.spans.contains_key(&at);
        if gives(SceneLocation::Mass(body.id)) {
            return None;
        }
        let [center, inertia] = [
            SceneLocation::Center(body.id),
            SceneLocation::Inertia(body.id),
        ];
        let (what, at) = match (gives(center), gives(inertia) && !body.is_held) {
            (true, _) => ("a centre of mass", center),
            (false, true) => ("an inertia", inertia),
            (false, false) => return None,
        };
        let message = format!(
            "body `{}` has {what} but no mass: it counts as 0 kg",
            shorten(body.name)
        );
        Some(self.warning(message, "without a mass", at))
    }
}

impl BodyFigures<'_> {
    /// √(inertia/mass), m; 0 without a mass.
    fn radius_of_gyration(&self) -> f64 {
        if self.mass > 0.0 {
            (self.inertia / self.mass).sqrt()
        } else {
            0.0
        }
    }
}
