//! The loads on the mechanism: where they act, and their magnitudes.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::coordinates::AnyCoordinate;
use crate::diagnostics::Span;
use crate::dimensions::{Dimensions, Notation, Plane};
use crate::joints::Joints;
use crate::kind::{kind, reject_unread_kind};
use crate::magnitude::{Magnitudes, Names};
use crate::names::read_each;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, POINT, SignRule, Value};
use crate::wording::shorten;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Coordinate, JointId, vec2};
use dwell_kinetostatics::load::AnyLoadKind;
use dwell_kinetostatics::{
    Direction, Load, LoadCoordinate, LoadKind, LoadShape as _, Magnitude, Mesh, Strength,
};
use toml::de::DeValue;

/// Where a load of some kind acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    Force,
    Torque,
    /// A point, against its velocity.
    Point,
    /// Two points, along their line.
    Points,
    /// A relative angle.
    Turn,
    /// A travel.
    Slide,
}

/// A spring without force at zero; its free length or angle is read separately.
const ELASTIC: Strength = Strength::Elastic { free: 0.0 };

/// Where the loads of each kind act, and their laws; gravity has neither.
const KINDS: [(&str, Place, Strength); 12] = [
    ("force", Place::Force, Strength::Direct),
    ("torque", Place::Torque, Strength::Direct),
    ("joint-torque", Place::Turn, Strength::Direct),
    ("point-to-point-force", Place::Points, Strength::Direct),
    ("slide-force", Place::Slide, Strength::Direct),
    ("spring", Place::Points, ELASTIC),
    ("torsion-spring", Place::Turn, ELASTIC),
    ("damper", Place::Points, Strength::Viscous),
    ("rotational-damper", Place::Turn, Strength::Viscous),
    ("slide-damper", Place::Slide, Strength::Viscous),
    ("drag", Place::Point, Strength::Quadratic),
    ("rotational-drag", Place::Turn, Strength::Quadratic),
];

/// The kind of a load of a reader.
type KindOf<R> = AnyLoadKind<PointOf<R>, <R as LoadReader>::Along, <R as LoadReader>::Special>;
type PointOf<R> = <<R as LoadReader>::Dimensions as Dimensions>::Point;

/// The reader of loads in the plane or in space.
pub(crate) trait LoadReader: Sized {
    type Dimensions: Notation;
    /// A coordinate along which a load acts.
    type Along: LoadCoordinate<Point = PointOf<Self>>;
    /// A kind of load that there is in the plane or in space alone.
    type Special;
    /// A coordinate on which a magnitude depends.
    type Coordinate: AnyCoordinate;

    fn bodies(&self) -> &Bodies<'_, Self::Dimensions>;
    fn magnitudes(&self) -> &Magnitudes<Self::Coordinate>;
    fn force(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<KindOf<Self>>;
    fn torque(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<KindOf<Self>>;
    fn turn(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<Self::Along>;
    fn slide(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<Self::Along>;

    /// The k-th load without its name, of a kind other than gravity.
    fn kind_and_size(
        &self,
        kind: &str,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        k: usize,
    ) -> Option<(KindOf<Self>, Magnitude<Self::Coordinate>)> {
        let Some(&(_, place, law)) = KINDS.iter().find(|(name, ..)| *name == kind) else {
            return reject_unread_kind(entry);
        };
        let load_kind = self.load_kind(place, law, entry, fields);
        let words = law.words();
        let (size, is_couple) = (
            words.magnitude,
            matches!(place, Place::Torque | Place::Turn),
        );
        let unit = words.units[usize::from(is_couple)];
        let magnitude = fields.require(size, &format!("add for instance `{size} = 10`, in {unit}"));
        fields.place(size, SceneLocation::Magnitude(k));
        let rule = match words.not_negative {
            None => NumberRule::new(&SI, SignRule::Any),
            Some(why) => NumberRule::new(&SI, SignRule::NotNegative).because(why),
        };
        let magnitude = magnitude.and_then(|e| self.magnitudes().read(e, fields, &rule));
        load_kind.zip(magnitude)
    }

    fn load_kind(
        &self,
        place: Place,
        law: Strength,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<KindOf<Self>> {
        let along = match place {
            Place::Force => return self.force(entry, fields),
            Place::Torque => return self.torque(entry, fields),
            Place::Point => {
                let (body, point) = self.moving_point(entry, fields)?;
                return Some(AnyLoadKind::Drag { body, point });
            }
            Place::Points => self.two_points(entry, fields),
            Place::Turn => self.turn(entry, fields),
            Place::Slide => self.slide(entry, fields),
        };
        let law = match (law, place) {
            (Strength::Elastic { .. }, Place::Turn) => {
                let help = "add `free-angle = 0.0`, the angle at which its torque is zero";
                let free = fields.require("free-angle", help);
                let free = free.and_then(|e| e.value.angle(fields.name_of(e)));
                free.map(|free| Strength::Elastic { free })
            }
            (Strength::Elastic { .. }, _) => {
                let rule = NumberRule::new(&fields.units().length, SignRule::NotNegative);
                let help = "add `free-length = 0.1`, its length without force";
                let free = fields.number("free-length", help, &rule);
                free.map(|free| Strength::Elastic { free })
            }
            (law, _) => Some(law),
        };
        Some(AnyLoadKind::Along(along?, law?))
    }

    /// A point of a moving body.
    fn moving_point(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<(BodyId, PointOf<Self>)> {
        let name = entry.value.string(fields.name_of(entry))?;
        let span = entry.value.span();
        let (body, k) = self.bodies().find_point(name, &span)?;
        self.require_moving_body(body, entry.value, &fields.what)?;
        Some((body, self.bodies().at(&(body, k, span))))
    }

    /// A load that acts on the ground alone has no effect, so it is taken for a mistake.
    fn require_moving_body(&self, body: BodyId, value: Value<'_>, what: &str) -> Option<()> {
        if self.bodies().ground != Some(body.0) {
            return Some(());
        }
        let message = format!("{what} acts on the ground");
        let help = "let it act on a moving body, or leave it out";
        value.reject(message, "it does not move", help)
    }

    fn two_points(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<Self::Along> {
        let what = fields.name_of(entry);
        let [a, b] = self
            .bodies()
            .find_two_points(entry.value, TWO_POINTS, what)?;
        let points = [self.bodies().at(&a), self.bodies().at(&b)];
        let bodies = self.require_different_bodies([(a.0, &a.2), (b.0, &b.2)], fields)?;
        Some(Self::Along::distance(bodies, points))
    }

    fn require_different_bodies(
        &self,
        ends: [(BodyId, &Span); 2],
        fields: &TableReader<'_>,
    ) -> Option<[BodyId; 2]> {
        let message = |name: &str| format!("{} acts between body `{name}` and itself", fields.what);
        let help = "a load within one rigid body has no effect";
        self.bodies().require_different(ends, message, help)
    }
}

impl Names<'_> {
    /// Every load of the section that was read well.
    pub(crate) fn loads(&self, fields: &TableReader<'_>) -> Vec<Load> {
        let mut gravity: Option<Span> = None;
        read_loads(fields, |entry, fields, k| {
            let load = self.kind_and_magnitude(fields, k)?;
            if load.0.is_gravity()
                && let Some(other) = gravity.replace(entry.key.clone())
            {
                let labels = [(&other, "here"), (&entry.key, "and here again")];
                let help = "keep one of them: both would add up";
                let log = entry.log();
                log.report("gravity is given twice", &labels, help);
            }
            Some(load)
        })
    }

    /// The k-th load without its name.
    fn kind_and_magnitude(
        &self,
        fields: &TableReader<'_>,
        k: usize,
    ) -> Option<(LoadKind, Magnitude)> {
        let (kind, entry) = kind(fields, "load")?;
        if kind == "gravity" {
            fields.place(kind, SceneLocation::Magnitude(k));
            return gravity(entry.value, &fields.name_of(entry));
        }
        self.kind_and_size(kind, entry, fields, k)
    }

    fn two_bodies(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<[BodyId; 2]> {
        let [a, b] = &self.bodies.find_two(entry.value, fields.name_of(entry))?;
        self.require_different_bodies([(a.0, &a.1), (b.0, &b.1)], fields)
    }
}

impl LoadReader for Names<'_> {
    type Dimensions = Plane;
    type Along = CoordinateFunction;
    type Special = Mesh;
    type Coordinate = Coordinate;

    fn bodies(&self) -> &Bodies<'_> {
        self.bodies
    }

    fn magnitudes(&self) -> &Magnitudes {
        self.magnitudes
    }

    fn turn(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<CoordinateFunction> {
        self.two_bodies(entry, fields)
            .map(CoordinateFunction::Angle)
    }

    fn slide(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<CoordinateFunction> {
        let name = entry.value.string(fields.name_of(entry))?;
        let joint = self.joints.sliding(name, &entry.value.span())?;
        self.joints.guide(joint).map(CoordinateFunction::Travel)
    }

    fn force(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<LoadKind> {
        let what = &fields.what;
        let place = self.moving_point(entry, fields);
        let direction = fields.require("direction", "add `direction = [1, 0]`");
        let direction =
            direction.and_then(|e| e.value.unit_vector(format_args!("the direction of {what}")));
        let body_fixed = match fields.get("frame") {
            None => Some(false),
            Some(e) => frame(e.value, what),
        };
        let (body, point) = place?;
        let (direction, body_fixed) = (direction?, body_fixed?);
        Some(LoadKind::Force {
            body,
            point,
            direction: if body_fixed {
                Direction::Body(direction)
            } else {
                Direction::Ground(direction)
            },
        })
    }

    fn torque(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<LoadKind> {
        let DeValue::String(name) = entry.value.get() else {
            return self.two_bodies(entry, fields).map(LoadKind::couple);
        };
        let body = self.bodies.find(name, &entry.value.span())?;
        self.require_moving_body(body, entry.value, &fields.what)?;
        Some(LoadKind::couple([BodyId(self.bodies.ground?), body]))
    }
}

/// Every load of a section that was read well; `read` makes kind and magnitude of the fields of the k-th.
pub(crate) fn read_loads<K, C>(
    fields: &TableReader<'_>,
    mut read: impl FnMut(&Entry<'_>, &TableReader<'_>, usize) -> Option<(K, Magnitude<C>)>,
) -> Vec<Load<K, C>> {
    read_each(fields, "a load", SceneLocation::Load, |k, entry| {
        let fields = TableReader::open(entry, format!("load `{}`", shorten(entry.name)))?;
        let (kind, magnitude) = read(entry, &fields, k)?;
        let name = entry.name.to_owned();
        Some(Load {
            name,
            kind,
            magnitude,
        })
    })
}

/// Appends the separating forces of the teeth that have a pressure angle, in the order of the file.
pub(crate) fn add_separating_forces(joints: &Joints<'_>, loads: &mut Vec<Load>) {
    for (k, parsed) in joints.list.iter().enumerate() {
        if let (Some((angle, at)), Some(joint)) = (&parsed.pressure_angle, &parsed.joint)
            && let Some(load) = Load::separating(joint, JointId(k), *angle)
        {
            let log = joints.log;
            log.place(SceneLocation::Load(loads.len()), &parsed.key);
            log.place(SceneLocation::Magnitude(loads.len()), at);
            loads.push(load);
        }
    }
}

/// An acceleration as a direction and a magnitude.
fn gravity(value: Value<'_>, what: &str) -> Option<(LoadKind, Magnitude)> {
    let direction = value.unit_vector(what)?;
    let [x, y] = value.pair(POINT, what)?;
    let [x, y] = [x, y].map(|component| component.quantity(&SI, what));
    let acceleration = vec2(x?, y?);
    let size = acceleration.x.hypot(acceleration.y);
    Some((LoadKind::Gravity { direction }, Magnitude::Constant(size)))
}

/// Whether the direction of the force rotates with its body.
fn frame(value: Value<'_>, what: &str) -> Option<bool> {
    match value.string(format_args!("the frame of {what}"))? {
        "ground" => Some(false),
        "body" => Some(true),
        name => {
            let message = format!("unknown frame `{}` of {what}", shorten(name));
            let help =
                "`\"ground\"` keeps the direction constant, `\"body\"` rotates it with the body";
            value.reject(message, "unknown frame", help)
        }
    }
}
