//! The exported machine: its names, the effects of its loads, and its functions of the coordinate as a sampler.

/// A machine of one degree of freedom, as plain data.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineDescription {
    /// The name that the names of files and functions begin with.
    pub name: String,
    /// The title of its scene. It may hold any character.
    pub title: String,
    /// The hash of its scene.
    pub scene_hash: String,
    /// The version of the program that exports it.
    pub version: String,
    /// The name of its coordinate.
    pub coordinate: String,
    /// Whether the coordinate is an angle (rad); otherwise it is a length (m).
    pub is_angle: bool,
    /// The interval of the coordinate.
    pub domain: Domain,
    /// q and q̇ at the start, rad and rad/s, or m and m/s.
    pub initial: [f64; 2],
    /// The loads and drives.
    pub loads: Vec<LoadDescription>,
    /// The reactions: name and unit, `N` or `N m`.
    pub reactions: Vec<(String, &'static str)>,
    /// The points whose positions are exported.
    pub points: Vec<String>,
    /// Reference sizes of the functions, which define rounding.
    pub sizes: ReferenceSizes,
    /// Sentences about the parts of the scene that are not exported.
    pub left_out: Vec<String>,
}

/// The interval of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Its lower end, rad or m; zero for whole revolutions.
    pub from: f64,
    /// Its upper end, rad or m.
    pub to: f64,
    /// The revolutions after which everything repeats; zero if it does not.
    pub revolutions: u32,
}

impl Domain {
    /// Its length, rad or m.
    pub fn length(&self) -> f64 {
        self.to - self.from
    }

    /// A coordinate without a value: outside of the domain, or beyond the largest number of revolutions.
    pub(crate) fn outside(&self) -> f64 {
        match self.revolutions {
            0 => 2.0 * self.to.abs().max(self.from.abs()) + 1.0,
            _ => 1e30,
        }
    }
}

/// Reference sizes of the functions of a machine: a function far below is rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceSizes {
    /// Size of m, kg m² or kg.
    pub inertia: f64,
    /// A length of the mechanism, m.
    pub length: f64,
    /// By load: the force of one unit of it, N.
    pub unit_loads: Vec<f64>,
}

/// A load or a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadDescription {
    /// Its name.
    pub name: String,
    /// How it acts.
    pub effect: LoadEffect,
    /// The unit of its parameter or of its input.
    pub unit: &'static str,
}

/// How a resistance grows with the velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resistance {
    /// F = −d w q̇.
    Linear,
    /// F = d |q̇| q̇; w is that of the drag at unit speed.
    Quadratic,
}

/// The effect of a load. F is the factor of w and of the c of the reactions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadEffect {
    /// A load with a potential; F is a parameter: acceleration of gravity, stiffness or force.
    Conservative {
        /// The parameter's value in the scene.
        magnitude: f64,
    },
    /// F is a parameter, and there is no potential.
    Constant {
        /// The parameter's value in the scene.
        magnitude: f64,
    },
    /// F by a resistance, whose d is a parameter.
    Damper {
        /// The parameter's value in the scene.
        damping: f64,
        /// How F follows from d.
        law: Resistance,
    },
    /// F by a resistance, whose d is an input.
    VariableDamper {
        /// The input's value at the start.
        initial: f64,
        /// How F follows from d.
        law: Resistance,
    },
    /// F is an input.
    Input {
        /// The input's value at the start.
        initial: f64,
    },
    /// A direct-current motor, whose voltage is an input.
    Motor(Motor),
}

/// A direct-current motor: L di/dt = u − R i − k N w q̇, F = N k i − N² J s̈ with s̈ = w q̈ + w′ q̇².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    /// k, N m/A or V s.
    pub torque_constant: f64,
    /// R, Ω.
    pub resistance: f64,
    /// L, H; zero where the current follows the voltage at once.
    pub inductance: f64,
    /// N.
    pub gear_ratio: f64,
    /// J, kg m².
    pub rotor_inertia: f64,
    /// The voltage at the start, V.
    pub initial_voltage: f64,
}

impl Motor {
    /// N, k, R, L and J.
    pub(crate) fn constants(&self) -> [f64; 5] {
        [
            self.gear_ratio,
            self.torque_constant,
            self.resistance,
            self.inductance,
            self.rotor_inertia,
        ]
    }
}

impl LoadEffect {
    /// Whether it has a potential.
    pub fn is_conservative(&self) -> bool {
        match self {
            Self::Conservative { .. } => true,
            Self::Constant { .. }
            | Self::Damper { .. }
            | Self::VariableDamper { .. }
            | Self::Input { .. }
            | Self::Motor(_) => false,
        }
    }

    /// The motor, if it is one.
    pub fn motor(&self) -> Option<&Motor> {
        match self {
            Self::Motor(motor) => Some(motor),
            Self::Conservative { .. }
            | Self::Constant { .. }
            | Self::Damper { .. }
            | Self::VariableDamper { .. }
            | Self::Input { .. } => None,
        }
    }

    /// Whether it has a rotor whose inertia counts.
    pub(crate) fn has_rotor(&self) -> bool {
        self.motor().is_some_and(|motor| motor.rotor_inertia != 0.0)
    }

    /// Whether it has a current that does not follow the voltage at once.
    pub(crate) fn has_current(&self) -> bool {
        self.motor().is_some_and(|motor| motor.inductance > 0.0)
    }

    /// The value of its parameter or input in the scene.
    pub(crate) fn scene_value(&self) -> f64 {
        match *self {
            Self::Conservative { magnitude } | Self::Constant { magnitude } => magnitude,
            Self::Damper { damping, .. } => damping,
            Self::VariableDamper { initial, .. } | Self::Input { initial } => initial,
            Self::Motor(motor) => motor.initial_voltage,
        }
    }
}

/// The functions that are looked up together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// m and ½m′; v and ½v′ of every conservative load; w of the others.
    Motion,
    /// a of every reaction, b of every reaction, then c, load by load.
    Reactions,
    /// x and y of every point.
    Positions,
}

impl PartKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Motion, Self::Reactions, Self::Positions];
}

/// A function of the coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// m and ½m′.
    Inertia,
    /// The potential of one unit of a conservative load, and half its slope.
    Potential(usize),
    /// w of a load without a potential.
    W(usize),
    /// a of a reaction.
    A(usize),
    /// b of a reaction.
    B(usize),
    /// c of a load and a reaction.
    C(usize, usize),
    /// x (0) or y (1) of a point.
    Position(usize, usize),
}

impl MachineDescription {
    /// The unit of the coordinate.
    pub(crate) fn unit(&self) -> &'static str {
        if self.is_angle { "rad" } else { "m" }
    }

    /// The unit of m.
    pub(crate) fn inertia_unit(&self) -> &'static str {
        if self.is_angle { "kg m2" } else { "kg" }
    }

    /// The functions of a part that come with half their slope.
    pub fn curves(&self, part: PartKind) -> Vec<Function> {
        match part {
            PartKind::Motion => {
                let conservative = self.loads_where(LoadEffect::is_conservative);
                let potentials = conservative.map(Function::Potential);
                std::iter::once(Function::Inertia)
                    .chain(potentials)
                    .collect()
            }
            PartKind::Reactions | PartKind::Positions => Vec::new(),
        }
    }

    /// The other functions of a part.
    pub fn columns(&self, part: PartKind) -> Vec<Function> {
        let (reactions, loads) = (0..self.reactions.len(), 0..self.loads.len());
        match part {
            PartKind::Motion => {
                let others = self.loads_where(|effect| !effect.is_conservative());
                others.map(Function::W).collect()
            }
            PartKind::Reactions => {
                let a = reactions.clone().map(Function::A);
                let b = reactions.clone().map(Function::B);
                let c = loads.flat_map(|l| reactions.clone().map(move |k| Function::C(l, k)));
                a.chain(b).chain(c).collect()
            }
            PartKind::Positions => {
                let axes = |point| [0, 1].map(|axis| Function::Position(point, axis));
                (0..self.points.len()).flat_map(axes).collect()
            }
        }
    }

    /// The loads of some effects.
    pub fn loads_where(&self, is: impl Fn(&LoadEffect) -> bool) -> impl Iterator<Item = usize> {
        let all = self.loads.iter().enumerate();
        all.filter(move |(_, load)| is(&load.effect))
            .map(|(k, _)| k)
    }

    /// The index of the function of a load in the part of motion: of its curve for a conservative load, otherwise of
    /// its column.
    pub(crate) fn place(&self, load: usize) -> usize {
        let conservative = self.loads[load].effect.is_conservative();
        let before = self.loads[..load].iter();
        let alike = before.filter(|load| load.effect.is_conservative() == conservative);
        // The first curve is that of m.
        alike.count() + usize::from(conservative)
    }

    /// By column of motion: whether it moves a rotor, so that its slope is needed.
    pub(crate) fn rotor_columns(&self) -> Vec<bool> {
        let loads = self.loads.iter().map(|load| &load.effect);
        let columns = loads.filter(|effect| !effect.is_conservative());
        columns.map(LoadEffect::has_rotor).collect()
    }

    /// The name of a function in messages.
    pub fn function_name(&self, function: Function) -> String {
        let load = |k: usize| self.loads.get(k).map_or("", |load| load.name.as_str());
        let reaction = |k: usize| self.reactions.get(k).map_or("", |(name, _)| name.as_str());
        match function {
            Function::Inertia => "m".to_owned(),
            Function::Potential(k) => format!("the potential of {}", load(k)),
            Function::W(k) => format!("w of {}", load(k)),
            Function::A(k) => format!("a of {}", reaction(k)),
            Function::B(k) => format!("b of {}", reaction(k)),
            Function::C(l, k) => format!("c of {} and {}", reaction(k), load(l)),
            Function::Position(k, axis) => {
                let name = self.points.get(k).map_or("", String::as_str);
                format!("{name}.{}", if axis == 0 { "x" } else { "y" })
            }
        }
    }

    /// The reference size of a function, in its own unit; values far below are rounding.
    pub(crate) fn reference_size(&self, function: Function) -> f64 {
        let ReferenceSizes {
            inertia,
            length,
            ref unit_loads,
        } = self.sizes;
        let unit_load = |k: usize| unit_loads.get(k).copied().unwrap_or(1.0);
        let arm = if self.is_angle { length } else { 1.0 };
        let of_reaction = |k: usize| match self.reactions.get(k) {
            Some((_, "N m")) => length,
            _ => 1.0,
        };
        match function {
            Function::Inertia => inertia,
            Function::Potential(k) => unit_load(k) * length,
            Function::W(k) => unit_load(k) * arm,
            Function::A(k) => inertia / arm * of_reaction(k),
            Function::B(k) => inertia / length * of_reaction(k),
            Function::C(l, k) => unit_load(l) * of_reaction(k),
            Function::Position(..) => length,
        }
    }

    /// Whether two functions are of one kind: of the same sort, load and unit.
    pub(crate) fn same_kind(&self, one: Function, other: Function) -> bool {
        let unit = |k: usize| self.reactions.get(k).map(|(_, unit)| *unit);
        let kind = |function| match function {
            Function::A(k) => (Function::A(0), unit(k)),
            Function::B(k) => (Function::B(0), unit(k)),
            Function::C(l, k) => (Function::C(l, 0), unit(k)),
            Function::Position(..) => (Function::Position(0, 0), None),
            Function::Inertia | Function::Potential(_) | Function::W(_) => (function, None),
        };
        kind(one) == kind(other)
    }
}

/// The exact functions of a machine, from which the exported ones are fitted and by which they are judged.
pub trait FunctionSampler {
    /// Why there is no value.
    type Error;

    /// All functions of a part at a coordinate (rad or m): `curves` as value and half the slope, in the orders of
    /// [`MachineDescription::curves`] and [`MachineDescription::columns`].
    ///
    /// # Errors
    /// Where the mechanism has no position.
    fn sample(
        &mut self,
        part: PartKind,
        q: f64,
        curves: &mut [[f64; 2]],
        columns: &mut [f64],
    ) -> Result<(), Self::Error>;
}
