//! Magnitudes of loads and drives: a number, an expression, or a table.

use crate::bodies::Bodies;
use crate::coordinates::{AnyCoordinate, ParsedCoordinates};
use crate::expression::expression;
use crate::joints::Joints;
use crate::keys;
use crate::law::{curve, interpolation};
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, SignRule, Value};
use crate::wording::shorten;
use dwell_geometry::Coordinate;
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Interpolation, Law};
use toml::de::DeValue;

/// The names that loads of a scene in the plane can use.
pub(crate) struct Names<'r> {
    pub(crate) bodies: &'r Bodies<'r>,
    pub(crate) joints: &'r Joints<'r>,
    pub(crate) magnitudes: &'r Magnitudes,
}

/// Reads magnitudes.
pub(crate) struct Magnitudes<C = Coordinate> {
    /// The signals an expression can name; none if its coordinate was wrong.
    signals: Vec<(String, Option<Signal<C>>)>,
}

impl<C: AnyCoordinate> Magnitudes<C> {
    pub(crate) fn new(named: &ParsedCoordinates<'_, C>) -> Self {
        let mut signals = vec![("t".to_owned(), Some(Signal::Time))];
        for c in &named.list {
            signals.push((c.name.to_owned(), c.coordinate.map(Signal::Value)));
            let velocity = format!("{}.velocity", c.name);
            signals.push((velocity, c.coordinate.map(Signal::Velocity)));
        }
        Self { signals }
    }

    /// Names of the signals.
    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        self.signals.iter().map(|(name, _)| name.as_str())
    }

    /// The magnitude that an entry of `fields` is: a number, an expression, or a table.
    pub(crate) fn read(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        rule: &NumberRule<'_>,
    ) -> Option<Magnitude<C>> {
        let what = fields.name_of(entry);
        match entry.value.get() {
            DeValue::String(_) => self.expression(entry.value, &what),
            DeValue::Table(_) => self.table(entry, &what, rule),
            DeValue::Integer(_) | DeValue::Float(_) => entry
                .value
                .quantity_with_sign(rule, what)
                .map(Magnitude::Constant),
            _ => entry
                .value
                .mismatch("a number, an expression in quotes, or a table", what),
        }
    }

    fn expression(&self, value: Value<'_>, what: &str) -> Option<Magnitude<C>> {
        let names: Vec<_> = self.names().collect();
        let parsed = expression(value, &names, what)?.retain_used();
        let used = parsed.variables().iter();
        let signals = used.map(|name| self.signal(name)?).collect::<Option<_>>()?;
        Some(Magnitude::Expression(parsed, signals))
    }

    /// The signal of that name, if there is one; none in it where its coordinate was wrong.
    fn signal(&self, name: &str) -> Option<Option<Signal<C>>> {
        let mut signals = self.signals.iter();
        signals.find(|(n, _)| n == name).map(|(_, signal)| *signal)
    }

    fn table(&self, entry: &Entry<'_>, what: &str, rule: &NumberRule<'_>) -> Option<Magnitude<C>> {
        let fields = TableReader::open(entry, what)?;
        fields.reject_unknown_keys(keys::table("magnitude"));
        let help = "write it as `{ table = [[0, 1], [1, 2]], of = \"phi\" }`";
        let table = fields.require("table", help);
        let signal = match fields.get("of") {
            None => Some(Signal::Time),
            Some(e) => self.of(e.value, what),
        };
        let (table, signal) = (table?.value, signal?);
        let unit = match signal {
            Signal::Time => &SI,
            Signal::Value(c) | Signal::Velocity(c) => fields.units().coordinate_unit(c.is_angle()),
        };
        let name = format!("the table of {what}");
        let rows = table.rows([unit, rule.unit], &name)?;
        if rule.sign == SignRule::NotNegative && rows.iter().any(|[_, y]| *y < 0.0) {
            return table.reject(format!("{name} goes below zero"), "negative", rule.why);
        }
        // Data of a load jump and have corners more often than not: it never goes beyond them.
        let interpolation = interpolation(&fields, Interpolation::Monotone)?;
        let law = curve(table, &name, &rows, interpolation)?;
        Some(Magnitude::Law(signal, Law::Spline(law)))
    }

    fn of(&self, value: Value<'_>, what: &str) -> Option<Signal<C>> {
        let name = value.string(format_args!("`of` in {what}"))?;
        if let Some(signal) = self.signal(name) {
            return signal;
        }
        let help = value.log().choices(name, "signals", self.names());
        let message = format!("`{}` cannot be the variable of a table", shorten(name));
        let label = "neither the time nor a coordinate or its velocity";
        value.reject(message, label, help)
    }
}
