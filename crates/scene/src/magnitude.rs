//! Magnitudes of loads and what is given to drives: a number, an expression of what moves, a table.

use crate::coordinates::Measures;
use crate::expression::expression;
use crate::fields::{Entry, Fields, Sign, mismatch, rows, signed, string};
use crate::keys;
use crate::law::spline;
use crate::names::shorten;
use crate::problem::{Problem, Problems};
use crate::units::{Unit, Units};
use dwell_geometry::Coordinate;
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Expression, Law};
use toml::de::DeValue;

/// What magnitudes are read with.
pub(crate) struct Magnitudes<'r> {
    units: &'r Units,
    /// The signals an expression can name, and their names.
    signals: Vec<(String, Option<Signal>)>,
}

/// What a magnitude is measured in, and what it has to be; `why` tells one who gave another sign.
pub(crate) struct Size<'s> {
    pub(crate) unit: &'s Unit,
    pub(crate) sign: Sign,
    pub(crate) why: &'s str,
}

impl<'r> Magnitudes<'r> {
    pub(crate) fn new(measures: &Measures<'_>, units: &'r Units) -> Self {
        let mut signals = vec![("t".to_owned(), Some(Signal::Time))];
        for m in &measures.list {
            signals.push((m.name.to_owned(), m.coordinate.map(Signal::Value)));
            let speed = m.coordinate.map(Signal::Speed);
            signals.push((format!("{}.speed", m.name), speed));
        }
        Self { units, signals }
    }

    /// The magnitude that `entry` of `owner` is: a number, an expression, or a table.
    pub(crate) fn read(
        &self,
        entry: &Entry<'_>,
        owner: &str,
        size: &Size<'_>,
        problems: &mut Problems,
    ) -> Option<Magnitude> {
        let what = format!("{} of {owner}", entry.name);
        match entry.value.get_ref() {
            DeValue::String(_) => self.expression(entry, &what, problems),
            DeValue::Table(_) => self.table(entry, &what, size, problems),
            DeValue::Integer(_) | DeValue::Float(_) => {
                let what = format_args!("{what}");
                let si = signed(entry.value, size.unit, size.sign, what, size.why, problems)?;
                Some(Magnitude::Constant(si))
            }
            _ => {
                let expected = "a number, an expression in quotes, or a table";
                mismatch(entry.value, expected, format_args!("{what}"), problems);
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
        size: &Size<'_>,
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
        let rows = rows(table.value, [unit, size.unit], &name, problems)?;
        if size.sign == Sign::NotNegative && rows.iter().any(|[_, y]| *y < 0.0) {
            problems.push(
                Problem::new(format!("{name} goes below zero"))
                    .at(table.value.span(), "negative")
                    .help(size.why),
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
