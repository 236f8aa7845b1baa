//! Links of PMKS+: a query in which numbers are digits of base 64, thousandths of their unit.

use crate::error::{DoorError, Result};
use crate::finding::{Effect, Place};
use crate::model::{Action, GROUND, Joint, Kind, Load, Model, both};
use crate::pose::{Matrix, Pose, Vector, scaled, sub, unit};
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
    /// The units of length, mass and force in SI.
    units: [f64; 3],
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

/// Whether a text may be a link.
pub(crate) fn is_link(text: &str) -> bool {
    text.contains('.') && !text.trim().contains(char::is_whitespace)
}

pub(crate) fn read(file: &TextFile) -> Result<(Model, Coverage)> {
    let text = file.text.trim();
    if !is_link(text) {
        let message = format!("`{}` is no link of PMKS+", file.file);
        return Err(DoorError::new(message, ""));
    }
    let query = text.split_once('?').map_or(text, |(_, query)| query);
    let place = file.place(1);
    let mut reader = Reader {
        file,
        model: Model::new("PMKS+ mechanism", place.clone()),
        place,
        units: [1.0; 3],
    };
    let digit = DIGITS.chars().nth(query.len().saturating_sub(1) % 62);
    if query.chars().next_back() != digit {
        return Err(reader.error("the check digit of the link is wrong: a part is missing"));
    }
    let fields: Vec<&str> = query.split('.').collect();
    let [settings, decimals, integers, enums, lists @ ..] = fields.as_slice() else {
        return Err(reader.error("the link has too few fields"));
    };
    reader.read_units(enums)?;
    let flags = reader.whole(settings)?;
    let gravity = if flags & NO_GRAVITY == 0 { -9.81 } else { 0.0 };
    reader.model.gravity = [0.0, gravity, 0.0];
    // Revolutions a minute, and for a slide its unit of length a second.
    let turns = reader.whole_or_negative(integers.split(',').next().unwrap_or_default())?;
    let travel = decimals.split(',').nth(1).map(|text| reader.decimal(text));
    let travel = match travel.transpose()?.unwrap_or_default() {
        0.0 => 1.0,
        given => given,
    };
    let sign = if flags & CLOCKWISE == 0 { 1.0 } else { -1.0 };
    let speeds = [turns * TAU / 60.0, travel * reader.units[0]].map(|speed| sign * speed);
    let mut lists = lists.split(|field| field.is_empty());
    let [joints, links, forces] = [(); 3].map(|()| lists.next().unwrap_or_default());
    let pins = joints.iter().map(|joint| reader.pin(joint));
    let mut pins = pins.collect::<Result<Vec<_>>>()?;
    for link in links {
        reader.link(link, &mut pins)?;
    }
    for force in forces {
        reader.force(force)?;
    }
    pins.iter().for_each(|pin| reader.joints(pin, speeds));
    let text = "colours, scale, time step, grid and active object: left out, nothing lost";
    reader.place.note(Effect::Nothing, text);
    let tokens = query.split(['.', ',']);
    let all = tokens.filter(|token| !token.is_empty()).count();
    let named = all.min(links.len() + 1 + integers.split(',').count());
    let read = all - named;
    Ok((reader.model, Coverage { all, read, named }))
}

impl Reader<'_> {
    fn error(&self, message: &str) -> DoorError {
        let span = 0..self.file.text.trim_end().len();
        self.file.error(span, message, "")
    }

    /// A whole number of 0 or more.
    fn whole(&self, text: &str) -> Result<u64> {
        let mut digits = text.chars().map(|c| DIGITS.find(c));
        let step = |value: u64, digit: usize| value.checked_mul(64)?.checked_add(digit as u64);
        let value = digits.try_fold(0u64, |value, digit| step(value, digit?));
        value.ok_or_else(|| self.error(&format!("`{text}` is no number of PMKS+")))
    }

    /// A leading zero means that the number is negative.
    fn whole_or_negative(&self, text: &str) -> Result<f64> {
        match text.strip_prefix('0') {
            Some(digits) if !digits.is_empty() => Ok(-(self.whole(digits)? as f64)),
            _ => Ok(self.whole(text)? as f64),
        }
    }

    /// Thousandths.
    fn decimal(&self, text: &str) -> Result<f64> {
        Ok(self.whole_or_negative(text)? / 1000.0)
    }

    fn read_units(&mut self, enums: &str) -> Result<()> {
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
            self.place.kept(text);
        }
        self.units = [length, mass, force];
        Ok(())
    }

    fn point(&self, x: &str, y: &str) -> Result<Vector> {
        let point = [self.decimal(x)?, self.decimal(y)?, 0.0];
        Ok(scaled(point, self.units[0]))
    }

    /// The first fields of a part, and the rest.
    fn fields<'f, const N: usize>(
        &self,
        what: &str,
        text: &'f str,
    ) -> Result<([&'f str; N], Vec<&'f str>)> {
        let mut all = text.split(',');
        let first: Vec<&str> = all.by_ref().take(N).collect();
        let few = |_| self.error(&format!("the {what} `{text}` has too few fields"));
        Ok((first.try_into().map_err(few)?, all.collect()))
    }

    fn pin(&self, text: &str) -> Result<Pin> {
        let ([id, name, x, y, angle], _) = self.fields("joint", text)?;
        let (flags, id) = split_first(id);
        let flags = self.whole(flags)?;
        let grounded = (flags & GROUNDED != 0).then_some(GROUND);
        Ok(Pin {
            flags,
            id: id.to_owned(),
            name: if name.is_empty() { id } else { name }.to_owned(),
            at: self.point(x, y)?,
            angle: self.decimal(angle)?,
            bodies: grounded.into_iter().collect(),
        })
    }

    fn link(&mut self, text: &str, pins: &mut [Pin]) -> Result<()> {
        let ([id, name, mass, moment, x, y, _colour], joints) = self.fields("link", text)?;
        let (root, kind_and_id) = split_first(id);
        let (_kind, id) = split_first(kind_and_id);
        if root != "Y" {
            let text = format!("link {id}: a part of a compound link, which has the mass");
            self.place.kept(text);
            return Ok(());
        }
        let name = if name.is_empty() { id } else { name };
        let [length, mass_unit, _] = self.units;
        let mass = self.decimal(mass)? * mass_unit;
        let moment = self.decimal(moment)? * mass_unit * length * length;
        if mass < 0.0 {
            return Err(self.error(&format!("the mass of link {name} is negative")));
        }
        let center = Pose::new(self.point(x, y)?, Matrix::IDENTITY);
        let place = self.place.clone();
        let number = self.model.push_body(name, place, Pose::IDENTITY);
        let body = &mut self.model.bodies[number];
        body.add_mass(mass, center, Matrix::diagonal([moment; 3]));
        for joint in joints.into_iter().take_while(|joint| !joint.is_empty()) {
            let pin = pins.iter_mut().find(|pin| pin.id == joint);
            let Some(pin) = pin else {
                return Err(self.error(&format!("link {name} has an unknown joint `{joint}`")));
            };
            pin.bodies.push(number);
            if pin.bodies.len() == 1 {
                body.points.push((pin.name.clone(), pin.at));
            }
        }
        Ok(())
    }

    /// The joints of a pin: its first body with each of the others.
    fn joints(&mut self, pin: &Pin, speeds: [f64; 2]) {
        let z = [0.0, 0.0, 1.0];
        let (kind, axis, speed, range) = match pin.flags {
            flags if flags & PRISMATIC != 0 => {
                let axis = [pin.angle.cos(), pin.angle.sin(), 0.0];
                (Kind::Slide, axis, speeds[1], self.units[0])
            }
            flags if flags & WELDED != 0 => (Kind::Fixed, z, 0.0, 0.0),
            _ => (Kind::Hinge, z, speeds[0], TAU),
        };
        // A revolution, or a unit of length.
        let law = match speed {
            0.0 => ("0".to_owned(), 1.0),
            _ => (format!("{speed}*t"), range / speed.abs()),
        };
        let first = self.model.joints.len();
        for other in pin.bodies.iter().skip(1) {
            let name = match pin.bodies.len() {
                2 => pin.name.clone(),
                _ => format!("{}-{}", pin.name, self.model.bodies[*other].name),
            };
            let ends = both([pin.bodies[0], *other], Pose::along(pin.at, axis));
            let joint = Joint::new(name, self.place.clone(), kind, ends);
            self.model.joints.push(joint);
        }
        let drives = pin.flags & INPUT != 0 && kind != Kind::Fixed;
        if drives && self.model.joints.len() > first {
            self.model.drive(first).law = Some(law);
        }
    }

    fn force(&mut self, text: &str) -> Result<()> {
        let ([id, link, name, sx, sy, ex, ey, size], _) = self.fields("force", text)?;
        let flags = self.whole(split_first(id).0)?;
        let mut bodies = self.model.bodies.iter();
        let body = bodies.position(|body| body.name == link);
        let unknown = || self.error(&format!("force {name} acts on an unknown link `{link}`"));
        let body = body.ok_or_else(unknown)?;
        let [start, end] = [self.point(sx, sy)?, self.point(ex, ey)?];
        let none = || self.error(&format!("force {name} has no direction"));
        let outward = unit(sub(end, start)).ok_or_else(none)?;
        let sign = if flags & OUTWARD != 0 { 1.0 } else { -1.0 };
        let size = self.decimal(size)? * self.units[2] * sign;
        self.model.loads.push(Load {
            name: name.to_owned(),
            at: vec![(body, start)],
            action: Action::Force {
                force: scaled(outward, size),
                turns: flags & LOCAL != 0,
            },
        });
        Ok(())
    }
}

/// The first character of a text, and the rest.
fn split_first(text: &str) -> (&str, &str) {
    text.split_at(text.chars().next().map_or(0, char::len_utf8))
}
