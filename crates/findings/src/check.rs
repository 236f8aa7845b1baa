//! The independent checks, by number and name.

use std::fmt;

/// The independent check that a finding belongs to. Its number orders reports and names it in tables.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Check {
    /// Poses meet every constraint equation, and stay on one branch.
    #[default]
    ConstraintClosure,
    /// The generalised inertia is twice the kinetic energy at unit velocity.
    KineticEnergy,
    /// Half the derivative of the inertia, and Lagrange's equations, by differences of the energy.
    EnergySlope,
    /// Reactions, by the constraint released as a coordinate.
    ReleasedConstraint,
    /// Power of actuators and loads is the rate of the kinetic energy.
    Power,
    /// The period and the time history of a free motion by quadrature.
    Period,
    /// Free motion against the multibody equations in absolute coordinates.
    MultibodyMotion,
    /// External forces are the rate of the momentum of the whole mechanism.
    Momentum,
    /// Newton's and Euler's equations of each body.
    NewtonEuler,
    /// Published values, and values computed by other programs.
    ReferenceValues,
    /// The evaluation repeated in single precision and in double-double numbers.
    Rounding,
    /// Closed forms.
    ClosedForms,
    /// Written rows meet the constraint equations of the scene's text.
    WrittenPositions,
    /// Written rows change by the integrals of their written rates.
    WrittenRates,
    /// Written forces meet Newton's and Euler's equations of each body, and of its cut parts.
    WrittenForces,
    /// Written sums over the mechanism: momentum, powers, energies, reduced parameters.
    WrittenTotals,
    /// Written values of laws, expressions and tables against a second reading of the scene.
    WrittenLaws,
    /// Numbers that several commands or files write by different computations.
    WrittenTwice,
    /// The same scene written in another system of units.
    WrittenUnits,
    /// Printed sentences against the numbers of the files.
    WrittenSentences,
    /// Changes of energy between written rows of a motion against the power of all forces.
    WrittenEnergy,
}

impl Check {
    /// All checks in the order of their numbers.
    pub const ALL: [Self; 21] = [
        Self::ConstraintClosure,
        Self::KineticEnergy,
        Self::EnergySlope,
        Self::ReleasedConstraint,
        Self::Power,
        Self::Period,
        Self::MultibodyMotion,
        Self::Momentum,
        Self::NewtonEuler,
        Self::ReferenceValues,
        Self::Rounding,
        Self::ClosedForms,
        Self::WrittenPositions,
        Self::WrittenRates,
        Self::WrittenForces,
        Self::WrittenTotals,
        Self::WrittenLaws,
        Self::WrittenTwice,
        Self::WrittenUnits,
        Self::WrittenSentences,
        Self::WrittenEnergy,
    ];

    /// The number, from 0: the index in [`Check::ALL`].
    pub const fn number(self) -> usize {
        self as usize
    }

    /// The name, without the number.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ConstraintClosure => "constraint closure",
            Self::KineticEnergy => "kinetic energy",
            Self::EnergySlope => "energy slope",
            Self::ReleasedConstraint => "released constraint",
            Self::Power => "power",
            Self::Period => "period",
            Self::MultibodyMotion => "multibody motion",
            Self::Momentum => "momentum",
            Self::NewtonEuler => "Newton–Euler",
            Self::ReferenceValues => "reference values",
            Self::Rounding => "rounding",
            Self::ClosedForms => "closed forms",
            Self::WrittenPositions => "written positions",
            Self::WrittenRates => "written rates",
            Self::WrittenForces => "written forces",
            Self::WrittenTotals => "written totals",
            Self::WrittenLaws => "written laws",
            Self::WrittenTwice => "written twice",
            Self::WrittenUnits => "written units",
            Self::WrittenSentences => "written sentences",
            Self::WrittenEnergy => "energy between rows",
        }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.number(), self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_checks_stand_in_the_order_of_their_numbers() {
        for (number, check) in Check::ALL.iter().enumerate() {
            assert_eq!(check.number(), number);
        }
        assert_eq!(Check::NewtonEuler.to_string(), "8 Newton–Euler");
    }
}
