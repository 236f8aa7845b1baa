//! The loads: what acts on the mechanism from outside, where, and how strongly.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::coordinates::Measures;
use crate::expression::expression;
use crate::fields::{
    Entry, Fields, POINT, Sign, angle, pair, quantity, rows, signed, string, unit_vector,
};
use crate::keys::{self, LOADS};
use crate::kind::kind;
use crate::law::spline;
use crate::names::{check, shorten};
use crate::problem::{Problem, Problems, Span};
use crate::units::{Unit, Units};
use dwell_geometry::{BodyId, Coordinate, Vec2, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Signal};
use dwell_laws::{Expression, Law};
use toml::de::DeValue;

/// A load as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct LoadText {
    pub(crate) key: Span,
    /// Where its magnitude is, or that of gravity.
    pub(crate) magnitude: Option<Span>,
    pub(crate) load: Option<Load>,
}

/// What loads are read with.
pub(crate) struct LoadReader<'r> {
    bodies: &'r Bodies<'r>,
    units: &'r Units,
    /// The signals an expression can name, and their names.
    signals: Vec<(String, Option<Signal>)>,
}

impl<'r> LoadReader<'r> {
    pub(crate) fn new(bodies: &'r Bodies<'r>, measures: &Measures<'_>, units: &'r Units) -> Self {
        let mut signals = vec![("t".to_owned(), Some(Signal::Time))];
        for m in &measures.list {
            signals.push((m.name.to_owned(), m.coordinate.map(Signal::Value)));
            let speed = m.coordinate.map(Signal::Speed);
            signals.push((format!("{}.speed", m.name), speed));
        }
        Self {
            bodies,
            units,
            signals,
        }
    }

    /// Every load of the section.
    pub(crate) fn read(&self, fields: &Fields<'_>, problems: &mut Problems) -> Vec<LoadText> {
        let mut gravity: Option<Span> = None;
        let one = |entry: &Entry<'_>| {
            check("a load", entry.name, &entry.key, problems);
            let load = self.load(entry, problems);
            if let Some(Load {
                kind: LoadKind::Gravity { .. },
                ..
            }) = load.load
                && let Some(other) = gravity.replace(entry.key.clone())
            {
                problems.push(
                    Problem::new("gravity acts twice")
                        .at(other, "here")
                        .at(entry.key.clone(), "and here again")
                        .help("keep one of them: both would add up"),
                );
            }
            load
        };
        fields.entries.iter().map(one).collect()
    }

    fn load(&self, entry: &Entry<'_>, problems: &mut Problems) -> LoadText {
        let mut text = LoadText {
            key: entry.key.clone(),
            magnitude: None,
            load: None,
        };
        let what = format!("load `{}`", shorten(entry.name));
        let Some(fields) = Fields::open(entry, what, problems) else {
            return text;
        };
        let Some((word, held)) = kind(&fields, &entry.key, "load", &LOADS, problems) else {
            return text;
        };
        let (size, unit, sign) = match word {
            "gravity" => ("gravity", "m/s2", Sign::Any),
            "force" => ("magnitude", "N", Sign::Any),
            "torque" => ("magnitude", "N m", Sign::Any),
            "spring" => ("stiffness", "N/m", Sign::NotNegative),
            "torsion" => ("stiffness", "N m/rad", Sign::NotNegative),
            "damper" => ("constant", "N s/m", Sign::NotNegative),
            _ => ("constant", "N m s/rad", Sign::NotNegative),
        };
        if word == "gravity" {
            text.magnitude = Some(held.value.span());
            let read = gravity(held, &fields, problems);
            text.load = read.map(|(kind, magnitude)| named(entry, kind, magnitude));
            return text;
        }
        let kind = self.shape(word, held, entry, &fields, problems);
        let help = format!("add for instance `{size} = 10`, in {unit}");
        let magnitude = fields.need(size, &entry.key, &help, problems);
        text.magnitude = magnitude.map(|e| e.value.span());
        let magnitude = magnitude.and_then(|e| self.magnitude(e, &fields, sign, problems));
        text.load = kind
            .zip(magnitude)
            .map(|(kind, magnitude)| named(entry, kind, magnitude));
        text
    }

    fn shape(
        &self,
        word: &str,
        held: &Entry<'_>,
        entry: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<LoadKind> {
        match word {
            "force" => self.force(held, entry, fields, problems),
            "torque" => {
                let bodies = self.torque(held, fields, problems)?;
                Some(LoadKind::Torque { bodies })
            }
            "spring" => {
                let ends = self.two_points(held, fields, problems);
                let unit = &self.units.length;
                let help = "add `free = 0.1`: its length without force";
                let free = fields
                    .need("free", &entry.key, help, problems)
                    .and_then(|e| {
                        let what = format_args!("the free length of {}", fields.what);
                        signed(e.value, unit, Sign::NotNegative, what, "", problems)
                    });
                let (bodies, points) = ends?;
                Some(LoadKind::Spring {
                    bodies,
                    points,
                    free: free?,
                })
            }
            "damper" => {
                let (bodies, points) = self.two_points(held, fields, problems)?;
                Some(LoadKind::Damper { bodies, points })
            }
            "torsion" => {
                let bodies = self.two_bodies(held, fields, problems);
                let help = "add `free = 0.0`: the angle at which it is free";
                let free = fields
                    .need("free", &entry.key, help, problems)
                    .and_then(|e| {
                        let what = format_args!("the free angle of {}", fields.what);
                        angle(e.value, &self.units.angle, what, problems)
                    });
                Some(LoadKind::TorsionSpring {
                    bodies: bodies?,
                    free: free?,
                })
            }
            _ => {
                let bodies = self.two_bodies(held, fields, problems)?;
                Some(LoadKind::TorsionDamper { bodies })
            }
        }
    }

    fn force(
        &self,
        held: &Entry<'_>,
        entry: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<LoadKind> {
        let what = &fields.what;
        let name = string(held.value, format_args!("force of {what}"), problems);
        let at = name.and_then(|name| {
            let span = held.value.span();
            let (body, k) = self.bodies.find_point(name, &span, problems)?;
            self.moving(body, &span, what, problems)?;
            Some((body, self.bodies.at(&(body, k, span))))
        });
        let help = "add `direction = [1, 0]`";
        let direction = fields.need("direction", &entry.key, help, problems);
        let direction = direction
            .and_then(|e| unit_vector(e.value, &format!("the direction of {what}"), problems));
        let follows = match fields.get("frame") {
            None => Some(false),
            Some(e) => frame(e, what, problems),
        };
        let (body, point) = at?;
        Some(LoadKind::Force {
            body,
            point,
            direction: direction?,
            follows: follows?,
        })
    }

    fn torque(
        &self,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<[BodyId; 2]> {
        let DeValue::String(name) = held.value.get_ref() else {
            return self.two_bodies(held, fields, problems);
        };
        let at = held.value.span();
        let body = self.bodies.find(name, &at, problems)?;
        self.moving(body, &at, &fields.what, problems)?;
        Some([BodyId(self.bodies.ground?), body])
    }

    /// The ground takes every load without moving: one on it alone is a slip.
    fn moving(&self, body: BodyId, at: &Span, what: &str, problems: &mut Problems) -> Option<()> {
        if self.bodies.ground != Some(body.0) {
            return Some(());
        }
        problems.push(
            Problem::new(format!("{what} acts on the ground"))
                .at(at.clone(), "it does not move")
                .help("let it act on a moving body, or leave it out"),
        );
        None
    }

    fn two_points(
        &self,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<([BodyId; 2], [Vec2; 2])> {
        let what = format_args!("{} of {}", held.name, fields.what);
        let both = self
            .bodies
            .find_two_points(held.value, TWO_POINTS, what, problems)?;
        let points = [&both[0], &both[1]].map(|end| self.bodies.at(end));
        let bodies = self.different(both.map(|(body, _, at)| (body, at)), fields, problems)?;
        Some((bodies, points))
    }

    fn two_bodies(
        &self,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<[BodyId; 2]> {
        let what = format_args!("{} of {}", held.name, fields.what);
        let both = self.bodies.find_two(held.value, what, problems)?;
        self.different(both, fields, problems)
    }

    fn different(
        &self,
        [(a, at_a), (b, at_b)]: [(BodyId, Span); 2],
        fields: &Fields<'_>,
        problems: &mut Problems,
    ) -> Option<[BodyId; 2]> {
        if a != b {
            return Some([a, b]);
        }
        let name = &self.bodies.list[a.0].name;
        problems.push(
            Problem::new(format!(
                "{} acts between body `{name}` and itself",
                fields.what
            ))
            .at(at_a, "this body")
            .at(at_b, "and the same again")
            .help("what acts within one rigid body moves nothing"),
        );
        None
    }

    /// How strong a load is: a number, an expression, or a table.
    fn magnitude(
        &self,
        entry: &Entry<'_>,
        fields: &Fields<'_>,
        sign: Sign,
        problems: &mut Problems,
    ) -> Option<Magnitude> {
        let what = format!("{} of {}", entry.name, fields.what);
        let why = match entry.name {
            "stiffness" => "below zero it would push away instead of pulling back",
            _ => "below zero it would feed the motion instead of resisting it",
        };
        match entry.value.get_ref() {
            DeValue::String(_) => self.expression(entry, &what, problems),
            DeValue::Table(_) => self.table(entry, &what, (sign, why), problems),
            DeValue::Integer(_) | DeValue::Float(_) => {
                let what = format_args!("{what}");
                let si = signed(entry.value, &Unit::of_si(), sign, what, why, problems)?;
                Some(Magnitude::Constant(si))
            }
            _ => {
                let expected = "a number, an expression in quotes, or a table";
                crate::fields::mismatch(entry.value, expected, format_args!("{what}"), problems);
                None
            }
        }
    }

    fn expression(
        &self,
        entry: &Entry<'_>,
        what: &str,
        problems: &mut Problems,
    ) -> Option<Magnitude> {
        let names: Vec<_> = self.signals.iter().map(|(name, _)| name.as_str()).collect();
        let all = expression(entry.value, &names, what, problems)?;
        let used: Vec<_> = all.variables().iter().map(String::as_str).collect();
        let signals: Option<Vec<_>> = used.iter().map(|name| self.signal(name)).collect();
        // Read once more with the names that occur: a value for each is then all it takes.
        let text = string(entry.value, format_args!("{what}"), problems)?;
        let expression = Expression::parse(text, &used).ok()?;
        Some(Magnitude::Expression(expression, signals?))
    }

    /// The signal of that name; nothing if its coordinate was wrong, which has been reported.
    fn signal(&self, name: &str) -> Option<Signal> {
        self.signals.iter().find(|(n, _)| n == name)?.1
    }

    fn table(
        &self,
        entry: &Entry<'_>,
        what: &str,
        (sign, why): (Sign, &str),
        problems: &mut Problems,
    ) -> Option<Magnitude> {
        let fields = Fields::open(entry, what, problems)?;
        fields.allow(&keys::MAGNITUDE, problems);
        let help = "write it as `{ table = [[0, 1], [1, 2]], of = \"phi\" }`";
        let table = fields.need("table", &fields.span, help, problems);
        let signal = match fields.get("of") {
            None => Some(Signal::Time),
            Some(e) => self.of(e, what, problems),
        };
        let (table, signal) = (table?, signal?);
        let si = Unit::of_si();
        let unit = match signal {
            Signal::Time => &si,
            Signal::Value(c) | Signal::Speed(c) => self.units.of(Coordinate::is_angle(c)),
        };
        let name = format!("the table of {what}");
        let rows = rows(table.value, [unit, &si], &name, problems)?;
        if sign == Sign::NotNegative && rows.iter().any(|[_, y]| *y < 0.0) {
            problems.push(
                Problem::new(format!("{name} goes below zero"))
                    .at(table.value.span(), "negative")
                    .help(why),
            );
            return None;
        }
        let law = spline(table, &name, &rows, problems)?;
        Some(Magnitude::Law(signal, Law::Spline(law)))
    }

    fn of(&self, entry: &Entry<'_>, what: &str, problems: &mut Problems) -> Option<Signal> {
        let name = string(entry.value, format_args!("`of` in {what}"), problems)?;
        if self.signals.iter().any(|(n, _)| n == name) {
            return self.signal(name);
        }
        let names = self.signals.iter().map(|(n, _)| n.as_str());
        let help = problems.choices(name, "signals", names);
        problems.push(
            Problem::new(format!("`{}` is not what a table can be of", shorten(name)))
                .at(
                    entry.value.span(),
                    "neither the time nor a coordinate or its speed",
                )
                .help(help),
        );
        None
    }
}

fn named(entry: &Entry<'_>, kind: LoadKind, magnitude: Magnitude) -> Load {
    Load {
        name: entry.name.to_owned(),
        kind,
        magnitude,
    }
}

/// An acceleration as a direction and a magnitude.
fn gravity(
    held: &Entry<'_>,
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<(LoadKind, Magnitude)> {
    let what = format!("gravity of {}", fields.what);
    let direction = unit_vector(held.value, &what, problems)?;
    let [x, y] = pair(held.value, POINT, format_args!("{what}"), problems)?;
    let si = Unit::of_si();
    let mut one = |value| quantity(value, &si, format_args!("{what}"), problems);
    let (x, y) = (one(x), one(y));
    let acceleration = vec2(x?.1, y?.1);
    let size = acceleration.x.hypot(acceleration.y);
    Some((LoadKind::Gravity { direction }, Magnitude::Constant(size)))
}

/// Whether the force turns with its body.
fn frame(entry: &Entry<'_>, what: &str, problems: &mut Problems) -> Option<bool> {
    let name = string(entry.value, format_args!("the frame of {what}"), problems)?;
    match name {
        "ground" => Some(false),
        "body" => Some(true),
        _ => {
            problems.push(
                Problem::new(format!("unknown frame `{}` of {what}", shorten(name)))
                    .at(entry.value.span(), "unknown frame")
                    .help("`\"ground\"` keeps the direction, `\"body\"` turns it with the body"),
            );
            None
        }
    }
}
