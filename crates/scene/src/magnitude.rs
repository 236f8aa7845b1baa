//! Magnitudes of loads and drives: a number, an expression, or a table.

use crate::coordinates::ParsedCoordinates;
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::expression::expression;
use crate::keys;
use crate::law::spline;
use crate::table_reader::{
    Entry, SignRule, TableReader, mismatch, quantity_with_sign, rows, string,
};
use crate::units::{Unit, Units};
use crate::wording::shorten;
use dwell_geometry::Coordinate;
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Expression, Law};
use toml::de::DeValue;

/// Reads magnitudes.
pub(crate) struct Magnitudes<'r> {
    units: &'r Units,
    /// The signals an expression can name, and their names.
    signals: Vec<(String, Option<Signal>)>,
    /// Former names of signals, which are still read, and their current names.
    former_names: Vec<(String, String)>,
}

/// Unit and sign of a magnitude; `why` is the reason for the sign, shown where it is violated.
pub(crate) struct MagnitudeRule<'s> {
    pub(crate) unit: &'s Unit,
    pub(crate) sign: SignRule,
    pub(crate) why: &'s str,
}

impl<'r> Magnitudes<'r> {
    pub(crate) fn new(named_coordinates: &ParsedCoordinates<'_>, units: &'r Units) -> Self {
        let mut signals = vec![("t".to_owned(), Some(Signal::Time))];
        for m in &named_coordinates.list {
            signals.push((m.name.to_owned(), m.coordinate.map(Signal::Value)));
            let velocity = m.coordinate.map(Signal::Velocity);
            signals.push((format!("{}.velocity", m.name), velocity));
        }
        let former_names = named_coordinates.list.iter().map(|m| {
            let [former, current] = ["speed", "velocity"].map(|s| format!("{}.{s}", m.name));
            (former, current)
        });
        Self {
            units,
            signals,
            former_names: former_names.collect(),
        }
    }

    /// The magnitude that `entry` of `owner` is: a number, an expression, or a table.
    pub(crate) fn read(
        &self,
        entry: &Entry<'_>,
        owner: &str,
        rule: &MagnitudeRule<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Magnitude> {
        let what = format!("{} of {owner}", entry.name);
        match entry.value.get_ref() {
            DeValue::String(_) => self.expression(entry, &what, diagnostics),
            DeValue::Table(_) => self.table(entry, &what, rule, diagnostics),
            DeValue::Integer(_) | DeValue::Float(_) => {
                let what = format_args!("{what}");
                let si = quantity_with_sign(
                    entry.value,
                    rule.unit,
                    rule.sign,
                    what,
                    rule.why,
                    diagnostics,
                )?;
                Some(Magnitude::Constant(si))
            }
            _ => {
                let expected = "a number, an expression in quotes, or a table";
                mismatch(entry.value, expected, format_args!("{what}"), diagnostics);
                None
            }
        }
    }

    fn expression(
        &self,
        entry: &Entry<'_>,
        what: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<Magnitude> {
        let text = string(entry.value, format_args!("{what}"), diagnostics)?;
        let names: Vec<_> = self.signals.iter().map(|(name, _)| name.as_str()).collect();
        let former = self.former_names.iter().map(|(former, _)| former.as_str());
        let with_former: Vec<_> = names.iter().copied().chain(former).collect();
        let parsed = match Expression::parse(text, &with_former) {
            Ok(parsed) => parsed,
            // The message lists the current names only.
            Err(_) => expression(entry.value, &names, what, diagnostics)?,
        }
        .retain_used();
        let used = parsed.variables().iter();
        let signals = used.map(|name| self.signal(name, entry, diagnostics));
        // Collected before it is looked at: every former name is to be reported.
        let signals: Vec<_> = signals.collect();
        let signals = signals.into_iter().collect::<Option<Vec<_>>>()?;
        Some(Magnitude::Expression(parsed, signals))
    }

    /// The signal of that name, which `entry` uses; nothing if its coordinate was wrong, which has been reported.
    fn signal(
        &self,
        name: &str,
        entry: &Entry<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Signal> {
        let renamed = self.former_names.iter().find(|(former, _)| former == name);
        let name = renamed.map_or(name, |(former, current)| {
            diagnostics.warn_renamed(former, current, entry.value.span());
            current
        });
        self.signals.iter().find(|(n, _)| n == name)?.1
    }

    fn table(
        &self,
        entry: &Entry<'_>,
        what: &str,
        rule: &MagnitudeRule<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Magnitude> {
        let fields = TableReader::open(entry, what, diagnostics)?;
        fields.reject_unknown_keys(keys::table("magnitude"), diagnostics);
        let help = "write it as `{ table = [[0, 1], [1, 2]], of = \"phi\" }`";
        let table = fields.require("table", &fields.span, help, diagnostics);
        let signal = match fields.get("of") {
            None => Some(Signal::Time),
            Some(e) => self.of(e, what, diagnostics),
        };
        let (table, signal) = (table?, signal?);
        let si = Unit::si_unit();
        let unit = match signal {
            Signal::Time => &si,
            Signal::Value(c) | Signal::Velocity(c) => {
                self.units.coordinate_unit(Coordinate::is_angle(c))
            }
        };
        let name = format!("the table of {what}");
        let rows = rows(table.value, [unit, rule.unit], &name, diagnostics)?;
        if rule.sign == SignRule::NotNegative && rows.iter().any(|[_, y]| *y < 0.0) {
            diagnostics.push(
                Diagnostic::new(format!("{name} goes below zero"))
                    .label(table.value.span(), "negative")
                    .help(rule.why),
            );
            return None;
        }
        let law = spline(table, &name, &rows, diagnostics)?;
        Some(Magnitude::Law(signal, Law::Spline(law)))
    }

    fn of(&self, entry: &Entry<'_>, what: &str, diagnostics: &mut Diagnostics) -> Option<Signal> {
        let name = string(entry.value, format_args!("`of` in {what}"), diagnostics)?;
        let mut known = self.signals.iter().map(|(n, _)| n);
        let mut former = self.former_names.iter().map(|(n, _)| n);
        if known.any(|n| n == name) || former.any(|n| n == name) {
            return self.signal(name, entry, diagnostics);
        }
        let names = self.signals.iter().map(|(n, _)| n.as_str());
        let help = diagnostics.choices(name, "signals", names);
        diagnostics.push(
            Diagnostic::new(format!(
                "`{}` cannot be the variable of a table",
                shorten(name)
            ))
            .label(
                entry.value.span(),
                "neither the time nor a coordinate or its velocity",
            )
            .help(help),
        );
        None
    }
}
