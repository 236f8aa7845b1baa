//! Magnitudes of loads and drives: a number, an expression, or a table.

use crate::coordinates::ParsedCoordinates;
use crate::expression::expression;
use crate::keys;
use crate::law::spline;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, SignRule, Value};
use crate::wording::shorten;
use dwell_geometry::Coordinate;
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Expression, Law};
use toml::de::DeValue;

/// Reads magnitudes.
pub(crate) struct Magnitudes {
    /// The signals an expression can name, and their names.
    signals: Vec<(String, Option<Signal>)>,
    /// Former names of signals, which are still read, and their current names.
    former_names: Vec<[String; 2]>,
}

impl Magnitudes {
    pub(crate) fn new(named: &ParsedCoordinates<'_>) -> Self {
        let mut signals = vec![("t".to_owned(), Some(Signal::Time))];
        for m in &named.list {
            signals.push((m.name.to_owned(), m.coordinate.map(Signal::Value)));
            let velocity = m.coordinate.map(Signal::Velocity);
            signals.push((format!("{}.velocity", m.name), velocity));
        }
        let both = |name: &str| ["speed", "velocity"].map(|s| format!("{name}.{s}"));
        let former_names = named.list.iter().map(|m| both(m.name));
        Self {
            signals,
            former_names: former_names.collect(),
        }
    }

    /// The magnitude that an entry of `fields` is: a number, an expression, or a table.
    pub(crate) fn read(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        rule: &NumberRule<'_>,
    ) -> Option<Magnitude> {
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

    fn expression(&self, value: Value<'_>, what: &str) -> Option<Magnitude> {
        let text = value.string(what)?;
        let names: Vec<_> = self.signals.iter().map(|(name, _)| name.as_str()).collect();
        let former = self.former_names.iter().map(|[former, _]| former.as_str());
        let with_former: Vec<_> = names.iter().copied().chain(former).collect();
        let parsed = match Expression::parse(text, &with_former) {
            Ok(parsed) => parsed,
            // The message lists the current names only.
            Err(_) => expression(value, &names, what)?,
        }
        .retain_used();
        let used = parsed.variables().iter();
        // Collected before any is missed: every former name is to be reported.
        let signals: Vec<_> = used.map(|name| self.signal(name, value)).collect();
        let signals = signals.into_iter().collect::<Option<Vec<_>>>()?;
        Some(Magnitude::Expression(parsed, signals))
    }

    /// The signal of that name, which `value` uses; nothing if its coordinate was wrong, which has been reported.
    fn signal(&self, name: &str, value: Value<'_>) -> Option<Signal> {
        let renamed = self.former_names.iter().find(|[former, _]| former == name);
        let name = renamed.map_or(name, |[former, current]| {
            value.log().warn_renamed(former, current, value.span());
            current
        });
        self.signals.iter().find(|(n, _)| n == name)?.1
    }

    fn table(&self, entry: &Entry<'_>, what: &str, rule: &NumberRule<'_>) -> Option<Magnitude> {
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
            Signal::Value(c) | Signal::Velocity(c) => {
                fields.units().coordinate_unit(Coordinate::is_angle(c))
            }
        };
        let name = format!("the table of {what}");
        let rows = table.rows([unit, rule.unit], &name)?;
        if rule.sign == SignRule::NotNegative && rows.iter().any(|[_, y]| *y < 0.0) {
            return table.reject(format!("{name} goes below zero"), "negative", rule.why);
        }
        let law = spline(table, &name, &rows)?;
        Some(Magnitude::Law(signal, Law::Spline(law)))
    }

    fn of(&self, value: Value<'_>, what: &str) -> Option<Signal> {
        let name = value.string(format_args!("`of` in {what}"))?;
        let mut known = self.signals.iter().map(|(n, _)| n);
        let mut former = self.former_names.iter().map(|[n, _]| n);
        if known.any(|n| n == name) || former.any(|n| n == name) {
            return self.signal(name, value);
        }
        let names = self.signals.iter().map(|(n, _)| n.as_str());
        let help = value.log().choices(name, "signals", names);
        let message = format!("`{}` cannot be the variable of a table", shorten(name));
        let label = "neither the time nor a coordinate or its velocity";
        value.reject(message, label, help)
    }
}
