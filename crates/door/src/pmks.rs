//! Links of PMKS+: a query in which numbers are digits of base 64, thousandths of their unit.

use crate::error::DoorError;
use crate::finding::{Effect, Findings, Place};
use crate::model::{Body, End, GROUND, Joint, Kind, Load, Model, Motion};
use crate::pose::{Matrix, Pose, Vector, sub, unit};
use crate::settle::{Read, span};
use crate::xml::{Coverage, TextFile};
use std::f64::consts::TAU;

const DIGITS: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-";
/// Bits of the settings.
const CLOCKWISE: u64 = 1;
const NO_GRAVITY: u64 = 1 << 8;
/// Bits of a joint.
const PRISMATIC: u64 = 1;
const INPUT: u64 = 2;
const GROUNDED: u64 = 4;
const WELDED: u64 = 8;
/// Bits of a force.
const LOCAL: u64 = 1;
const OUTWARD: u64 = 2;
/// In N.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

struct Reader<'t> {
    file: &'t TextFile,
    place: Place,
    model: Model,
    coverage: Coverage,
}

/// Length, mass, and force in SI.
struct Units {
    length: f64,
    mass: f64,
    force: f64,
}

/// A joint of the link, with the bodies that it connects.
struct Pin {
    flags: u64,
    id: String,
    name: String,
    at: Vector,
    angle: f64,
    bodies: Vec<usize>,
}

pub(crate) fn read(file: &TextFile, findings: Findings) -> Result<Read, DoorError> {
    let text = file.text.trim();
    let query = text.split_once('?').map_or(text, |(_, query)| query);
    let place = file.place(1);
    let mut reader = Reader {
        file,
        model: Model::new("PMKS+ mechanism", &place, findings),
        place,
        coverage: Coverage::default(),
    };
    let digit = DIGITS.chars().nth(query.len().saturating_sub(1) % 62);
    if query.chars().next_back() != digit {
        return Err(reader.error("the check digit of the link is wrong: a part is missing"));
    }
    let fields: Vec<&str> = query.split('.').collect();
    let [settings, decimals, integers, enums, lists @ ..] = fields.as_slice() else {
        return Err(reader.error("the link has too few fields"));
    };
    // Revolutions a minute, and for a slide its unit of length a second.
    let turns =
        reader.decimal(integers.split(',').next().unwrap_or_default())? * 1000.0 * TAU / 60.0;
    let travel = decimals
        .split(',')
        .nth(1)
        .map_or(Ok(1.0), |text| reader.decimal(text))?;
    let units = reader.units(enums)?;
    let speeds = [
        turns,
        if travel == 0.0 { 1.0 } else { travel } * units.length,
    ];
    let links = reader.lists(reader.whole(settings)?, speeds, &units, lists)?;
    let tokens = query.split(['.', ',']).filter(|token| !token.is_empty());
    // Colours, the scale of the picture, the time step, the active object and the check digit.
    let named = links + 1 + integers.split(',').count();
    let read = tokens.count().saturating_sub(named);
    reader.coverage = Coverage {
        all: read + named,
        read,
        named,
    };
    let text = "colours, scale, time step, grid and active object: left out, nothing lost";
    reader.model.note(&reader.place, Effect::Nothing, text);
    span(&mut reader.model);
    Ok(Read {
        model: reader.model,
        moves: Vec::new(),
        coverage: reader.coverage,
    })
}

impl Reader<'_> {
    /// Reads joints, links and forces, and returns how many links there are.
    fn lists(
        &mut self,
        flags: u64,
        speeds: [f64; 2],
        units: &Units,
        lists: &[&str],
    ) -> Result<usize, DoorError> {
        let mut lists = lists.split(|field| field.is_empty());
        let [joints, links, forces] = [(); 3].map(|()| lists.next().unwrap_or_default());
        let pins = joints.iter().map(|joint| self.pin(joint, units));
        let mut pins = pins.collect::<Result<Vec<_>, _>>()?;
        for link in links {
            self.link(link, units, &mut pins)?;
        }
        let gravity = if flags & NO_GRAVITY == 0 { -9.81 } else { 0.0 };
        self.model.gravity = [0.0, gravity, 0.0];
        for force in forces {
            self.force(force, units)?;
        }
        let sign = if flags & CLOCKWISE == 0 { 1.0 } else { -1.0 };
        let speeds = speeds.map(|speed| sign * speed);
        pins.iter().for_each(|pin| self.joints(pin, speeds));
        Ok(links.len())
    }

    fn error(&self, message: &str) -> DoorError {
        let span = (0, self.file.text.trim_end().len());
        self.file.error(span, message.to_owned(), "")
    }

    /// A whole number of 0 or more.
    fn whole(&self, text: &str) -> Result<u64, DoorError> {
        let mut digits = text.chars().map(|c| DIGITS.find(c));
        let step = |value: u64, digit: usize| value.checked_mul(64)?.checked_add(digit as u64);
        let value = digits.try_fold(0u64, |value, digit| step(value, digit?));
        value.ok_or_else(|| self.error(&format!("`{text}` is no number of PMKS+")))
    }

    /// Thousandths; a leading zero means that the number is negative.
    fn decimal(&self, text: &str) -> Result<f64, DoorError> {
        let (sign, digits) = match text.strip_prefix('0') {
            Some(digits) if !digits.is_empty() => (-1.0, digits),
            _ => (1.0, text),
        };
        Ok(sign * self.whole(digits)? as f64 / 1000.0)
    }

    fn units(&self, enums: &str) -> Result<Units, DoorError> {
        // Length, angle, force; a fourth digit is cut off by its encoder.
        let digit = |k: usize| enums.get(k..=k).map_or(Ok(9), |digit| self.whole(digit));
        let (length, mass) = match digit(0)? {
            0 => (0.0254, 0.453_592_37),
            1 => (0.01, 1.0),
            2 => (1.0, 1.0),
            _ => return Err(self.error("the link has an unknown unit of length")),
        };
        let force = if digit(2)? == 0 { POUND_FORCE } else { 1.0 };
        if length != 1.0 {
            let text = "masses are read in kg or lb, moments of inertia in kg cm2 or lb in2";
            self.model.note(&self.place, Effect::Kept, text);
        }
        Ok(Units {
            length,
            mass,
            force,
        })
    }

    fn point(&self, x: &str, y: &str, units: &Units) -> Result<Vector, DoorError> {
        let [x, y] = [self.decimal(x)?, self.decimal(y)?];
        Ok([x * units.length, y * units.length, 0.0])
    }

    fn fields<'f, const N: usize>(
        &self,
        what: &str,
        text: &'f str,
    ) -> Result<([&'f str; N], Vec<&'f str>), DoorError> {
        let all: Vec<&str> = text.split(',').collect();
        let first = all.get(..N).and_then(|first| first.try_into().ok());
        let few = || self.error(&format!("the {what} `{text}` has too few fields"));
        let first = first.ok_or_else(few)?;
        Ok((first, all[N..].to_vec()))
    }

    fn pin(&self, text: &str, units: &Units) -> Result<Pin, DoorError> {
        let ([id, name, x, y, angle], _) = self.fields("joint", text)?;
        let (flags, id) = split_first(id);
        let flags = self.whole(flags)?;
        let grounded = (flags & GROUNDED != 0).then_some(GROUND);
        Ok(Pin {
            flags,
            id: id.to_owned(),
            name: if name.is_empty() { id } else { name }.to_owned(),
            at: self.point(x, y, units)?,
            angle: self.decimal(angle)?,
            bodies: grounded.into_iter().collect(),
        })
    }

    fn link(&mut self, text: &str, units: &Units, pins: &mut [Pin]) -> Result<(), DoorError> {
        let ([id, name, mass, moment, x, y, _colour], joints) = self.fields("link", text)?;
        let (root, kind_and_id) = split_first(id);
        let (_kind, id) = split_first(kind_and_id);
        if root != "Y" {
            let text = format!("link {id}: a part of a compound link, which has the mass");
            self.model.note(&self.place, Effect::Kept, text);
            return Ok(());
        }
        let number = self.model.bodies.len();
        let name = if name.is_empty() { id } else { name };
        let mut body = Body::new(name, self.place.clone(), Pose::IDENTITY);
        let mass = self.decimal(mass)? * units.mass;
        let moment = self.decimal(moment)? * units.mass * units.length * units.length;
        if mass < 0.0 {
            return Err(self.error(&format!("the mass of link {name} is negative")));
        }
        let center = self.point(x, y, units)?;
        body.add_mass(mass, center, Matrix::diagonal([moment; 3]));
        for joint in joints.into_iter().take_while(|joint| !joint.is_empty()) {
            let pin = pins.iter_mut().find(|pin| pin.id == joint);
            let unknown = || self.error(&format!("link {name} has an unknown joint `{joint}`"));
            let pin = pin.ok_or_else(unknown)?;
            pin.bodies.push(number);
            if pin.bodies.len() == 1 {
                body.points.push((pin.name.clone(), pin.at));
            }
        }
        self.model.push_frame(name, number, Pose::IDENTITY);
        self.model.bodies.push(body);
        Ok(())
    }

    /// The joints of a pin: its first body with each of the others.
    fn joints(&mut self, pin: &Pin, speeds: [f64; 2]) {
        let kind = match pin.flags {
            flags if flags & PRISMATIC != 0 => Kind::Slide,
            flags if flags & WELDED != 0 => Kind::Fixed,
            _ => Kind::Hinge,
        };
        let axis = match kind {
            Kind::Slide => [pin.angle.cos(), pin.angle.sin(), 0.0],
            _ => [0.0, 0.0, 1.0],
        };
        let frame = Pose::along(pin.at, axis);
        let ends: Vec<End> = pin
            .bodies
            .iter()
            .map(|body| End::new(*body, frame))
            .collect();
        for other in ends.iter().skip(1) {
            let name = match ends.len() {
                2 => pin.name.clone(),
                _ => format!("{}-{}", pin.name, self.model.bodies[other.body].name),
            };
            let joint = Joint::new(name, self.place.clone(), kind, [ends[0], *other]);
            self.model.joints.push(joint);
        }
        if pin.flags & INPUT != 0 && ends.len() > 1 && kind != Kind::Fixed {
            let first = self.model.joints.len() + 1 - ends.len();
            let speed = speeds[usize::from(kind == Kind::Slide)];
            self.model.drive(first).motion = Motion::Speed(speed);
        }
    }

    fn force(&mut self, text: &str, units: &Units) -> Result<(), DoorError> {
        let ([id, link, name, sx, sy, ex, ey, size], _) = self.fields("force", text)?;
        let flags = self.whole(split_first(id).0)?;
        let frame = self.model.frames.iter().find(|(one, ..)| one == link);
        let unknown = || self.error(&format!("force {name} acts on an unknown link `{link}`"));
        let body = frame.ok_or_else(unknown)?.1;
        let [start, end] = [self.point(sx, sy, units)?, self.point(ex, ey, units)?];
        let none = || self.error(&format!("force {name} has no direction"));
        let outward = unit(sub(end, start)).ok_or_else(none)?;
        let sign = if flags & OUTWARD != 0 { 1.0 } else { -1.0 };
        let size = self.decimal(size)? * units.force * sign;
        self.model.loads.push(Load::Force {
            name: name.to_owned(),
            at: (body, start),
            force: outward.map(|x| x * size),
            turns: flags & LOCAL != 0,
        });
        Ok(())
    }
}

/// The first character of a text, and the rest.
fn split_first(text: &str) -> (&str, &str) {
    text.split_at(text.chars().next().map_or(0, char::len_utf8))
}
