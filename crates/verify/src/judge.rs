//! From single differences to a verdict.

use dwell_findings::Finding;

/// How much of the truth's own estimated error the tolerance allows for.
const OWN_SHARE: f64 = 10.0;
/// Where the truth itself is worse than this it decides nothing, and the finding fails.
const BLUNTEST: f64 = 1e-6;

/// The largest difference met so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Worst {
    absolute: f64,
    relative: f64,
    unit: &'static str,
    place: String,
    own: f64,
    condition: f64,
    met: usize,
    refusal: Option<String>,
}

/// One comparison.
pub(crate) struct Reading {
    /// Subject less truth.
    pub(crate) difference: f64,
    /// What it is relative to.
    pub(crate) scale: f64,
    /// The truth's own estimated error, in the unit of the difference.
    pub(crate) own: f64,
    /// The unit.
    pub(crate) unit: &'static str,
    /// Condition number of the dense rows there; 1 where it has no meaning.
    pub(crate) condition: f64,
}

impl Worst {
    /// Takes a comparison in; the place is only written down if it is the worst.
    pub(crate) fn meet(&mut self, reading: &Reading, place: impl FnOnce() -> String) {
        let over_scale = |value: f64| match value.abs() {
            // Zero agrees with zero even where nothing gives a scale.
            0.0 => 0.0,
            size => size / reading.scale,
        };
        let relative = over_scale(reading.difference);
        self.met += 1;
        self.own = self.own.max(over_scale(reading.own));
        if self.met == 1 || worse(relative, self.relative) {
            self.absolute = reading.difference.abs();
            self.relative = relative;
            self.unit = reading.unit;
            self.condition = reading.condition;
            self.place = place();
        }
    }

    /// Notes that something could not be compared at all, which fails the finding.
    pub(crate) fn refuse(&mut self, message: String) {
        self.refusal.get_or_insert(message);
    }

    /// The worse of two.
    pub(crate) fn merge(mut self, other: Self) -> Self {
        let worse = other.met > 0 && (self.met == 0 || worse(other.relative, self.relative));
        let (met, own) = (self.met + other.met, self.own.max(other.own));
        let refusal = self.refusal.take().or(other.refusal.clone());
        let kept = if worse { other } else { self };
        Self {
            met,
            own,
            refusal,
            ..kept
        }
    }
}

/// Whether `new` is worse than `old`. What is not a number is the worst there is, and stays.
fn worse(new: f64, old: f64) -> bool {
    !old.is_nan() && (new.is_nan() || new > old)
}

/// The words of a finding, and the tolerance.
pub(crate) struct Check {
    pub(crate) key: &'static str,
    pub(crate) truth: &'static str,
    pub(crate) compared: &'static str,
    pub(crate) over: String,
    pub(crate) scale: &'static str,
    pub(crate) tolerance: f64,
    pub(crate) why: &'static str,
}

impl Check {
    /// The verdict. The tolerance gives way to ten times the truth's own estimated error where
    /// that is larger, up to a limit: next to a dead point no difference is good, and a finding
    /// must judge the subject, not the truth. The words say when this happened.
    pub(crate) fn judge(self, worst: Worst) -> Finding {
        let allowed = (OWN_SHARE * worst.own).min(BLUNTEST);
        let tolerance = self.tolerance.max(allowed);
        let mut why = self.why.to_owned();
        if worst.own > 0.0 {
            why.push_str(&format!("; own estimated error {:.0e}", worst.own));
        }
        if tolerance > self.tolerance {
            why.push_str(&format!(
                ", ten times which replaces the usual {:.0e}",
                self.tolerance
            ));
        }
        let mut finding = Finding {
            key: self.key.into(),
            truth: self.truth.into(),
            compared: self.compared.into(),
            over: self.over,
            absolute: worst.absolute,
            unit: worst.unit.into(),
            relative: worst.relative,
            scale: self.scale.into(),
            worst: worst.place,
            tolerance,
            why,
            condition: worst.condition.max(1.0),
            integrated: false,
            pass: worst.met > 0 && worst.relative <= tolerance,
        };
        let refusal = match worst.refusal {
            None if worst.met == 0 => Some("nothing could be compared".to_owned()),
            refusal => refusal,
        };
        if let Some(message) = refusal {
            finding.pass = false;
            finding.absolute = f64::NAN;
            finding.relative = f64::NAN;
            finding.worst = message;
        }
        finding
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check() -> Check {
        Check {
            key: "k",
            truth: "0",
            compared: "this with that",
            over: "all".into(),
            scale: "one",
            tolerance: 1e-9,
            why: "because",
        }
    }

    fn worst(differences: &[f64], own: f64) -> Worst {
        let mut worst = Worst::default();
        for &difference in differences {
            let reading = Reading {
                difference,
                scale: 2.0,
                own,
                unit: "N",
                condition: 1.0,
            };
            worst.meet(&reading, || format!("at {difference}"));
        }
        worst
    }

    #[test]
    fn the_largest_is_kept_whatever_the_order() {
        for differences in [[1e-10, -4e-9, 1e-9], [-4e-9, 1e-9, 1e-10]] {
            let [a, b, c] = differences.map(|d| worst(&[d], 0.0));
            let finding = check().judge(a.merge(b).merge(c));
            assert_eq!((finding.absolute, finding.relative), (4e-9, 2e-9));
            assert_eq!(finding.worst, "at -0.000000004");
            assert!(!finding.pass);
        }
        assert!(check().judge(worst(&[1e-9], 0.0)).pass);
    }

    #[test]
    fn not_a_number_and_nothing_fail() {
        for differences in [&[f64::NAN, 1e-12][..], &[1e-12, f64::NAN], &[]] {
            assert!(!check().judge(worst(differences, 0.0)).pass);
        }
        let merged = worst(&[f64::NAN], 0.0).merge(worst(&[1.0], 0.0));
        assert!(check().judge(merged).relative.is_nan());
        let merged = worst(&[1.0], 0.0).merge(worst(&[f64::NAN], 0.0));
        assert!(check().judge(merged).relative.is_nan());
    }

    #[test]
    fn a_refusal_fails_and_is_told() {
        let mut refused = worst(&[0.0], 0.0);
        refused.refuse("no answer".into());
        let finding = check().judge(worst(&[0.0], 0.0).merge(refused));
        assert!(!finding.pass);
        assert_eq!(finding.worst, "no answer");
    }

    #[test]
    fn a_blunt_truth_widens_its_tolerance_but_not_for_ever() {
        assert!(check().judge(worst(&[1e-8], 1e-8)).pass);
        assert!(!check().judge(worst(&[1e-4], 1e-2)).pass);
    }
}
