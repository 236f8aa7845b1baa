//! Classes of defaults, and elements with the attributes that their classes give.

use crate::error::DoorError;
use crate::pose::{Matrix, Pose, cross, length, unit};
use crate::xml::Element;
use std::collections::HashMap;

/// The name of the class of all elements.
const MAIN: &str = "main";

/// Angles and their order, from `compiler`.
#[derive(Clone, Copy)]
pub(super) struct Angles {
    /// What an angle of the file is in rad.
    pub(super) unit: f64,
    pub(super) sequence: [char; 3],
}

impl Default for Angles {
    fn default() -> Self {
        let (unit, sequence) = (1f64.to_radians(), ['x', 'y', 'z']);
        Self { unit, sequence }
    }
}

#[derive(Default)]
pub(super) struct Defaults<'d> {
    /// The class of all elements: that of the first section.
    main: Option<&'d str>,
    classes: HashMap<&'d str, Class<'d>>,
}

#[derive(Default)]
struct Class<'d> {
    parent: Option<&'d str>,
    elements: Vec<Element<'d>>,
}

impl<'d> Defaults<'d> {
    /// Reads a section of defaults.
    pub(super) fn add(&mut self, section: Element<'d>, parent: Option<&'d str>) {
        let main = *self
            .main
            .get_or_insert(section.attribute("class").unwrap_or(MAIN));
        let name = section.attribute("class").unwrap_or(main);
        for child in section.children() {
            if child.tag() == "default" {
                self.add(child, Some(name));
            } else {
                let class = self.classes.entry(name).or_default();
                class.elements.push(child.read());
            }
        }
        let class = self.classes.entry(name).or_default();
        let parent = parent.or(Some(main)).filter(|parent| *parent != name);
        class.parent = class.parent.or(parent);
    }

    /// An element with the defaults of its class, or of that of the bodies around it.
    pub(super) fn item(
        &self,
        element: Element<'d>,
        inherited: Option<&'d str>,
    ) -> Result<Item<'d>, DoorError> {
        let own = element.attribute("class");
        let mut class = own.or(inherited).or(self.main).unwrap_or(MAIN);
        let unknown = own.is_some() && !self.classes.contains_key(class);
        element.known((!unknown).then_some(()), "class of defaults", class)?;
        let mut chain = Vec::new();
        // A class is its own ancestor only in a file that no program reads.
        for _ in 0..=self.classes.len() {
            let Some(one) = self.classes.get(class) else {
                break;
            };
            let same = |other: &&Element<'d>| other.tag() == element.tag();
            chain.extend(one.elements.iter().rev().filter(same));
            match one.parent {
                Some(parent) => class = parent,
                None => break,
            }
        }
        Ok(Item { element, chain })
    }

    /// What the readers of elements know of their defaults counts as read; the rest is named.
    pub(super) fn read_known(&self) {
        for element in self.classes.values().flat_map(|class| &class.elements) {
            for name in element.names() {
                if element.is_known(name) {
                    let _ = element.attribute(name);
                }
            }
        }
    }
}

/// An element with its defaults, the nearest first.
#[derive(Clone)]
pub(super) struct Item<'d> {
    pub(super) element: Element<'d>,
    chain: Vec<Element<'d>>,
}

impl<'d> Item<'d> {
    pub(super) fn text(&self, name: &str) -> Option<&'d str> {
        let own = self.element.attribute(name);
        own.or_else(|| self.chain.iter().find_map(|one| one.attribute(name)))
    }

    pub(super) fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, DoorError> {
        let text = self.text(name);
        text.map(|text| self.element.numbers(name, text))
            .transpose()
    }

    pub(super) fn vector<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, DoorError> {
        let text = self.text(name);
        text.map(|text| self.element.exactly(name, text))
            .transpose()
    }

    /// A number, or its default; of several the first, if the others are zero.
    pub(super) fn value(&self, name: &str, default: f64) -> Result<f64, DoorError> {
        let numbers = self.numbers(name)?.unwrap_or_default();
        if numbers.iter().skip(1).any(|x| *x != 0.0) {
            let label = self.element.label();
            self.element
                .lost(format!("{label} {name}: all but the first number"));
        }
        Ok(numbers.first().copied().unwrap_or(default))
    }

    pub(super) fn is(&self, name: &str, value: &str) -> bool {
        self.text(name) == Some(value)
    }

    /// The frame of the element in that around it.
    pub(super) fn pose(&self, angles: Angles) -> Result<Pose, DoorError> {
        let origin = self.vector("pos")?.unwrap_or_default();
        Ok(Pose::new(origin, self.turn(angles)?))
    }

    fn turn(&self, angles: Angles) -> Result<Matrix, DoorError> {
        let turn = if let Some(quat) = self.vector("quat")? {
            Matrix::quaternion(quat)
        } else if let Some([x, y, z, angle]) = self.vector("axisangle")? {
            unit([x, y, z]).map(|axis| Matrix::about(axis, angle * angles.unit))
        } else if let Some([a, b, c, d, e, f]) = self.vector("xyaxes")? {
            let x = unit([a, b, c]);
            let z = x.and_then(|x| unit(cross(x, [d, e, f])));
            x.zip(z)
                .map(|(x, z)| Matrix([x, cross(z, x), z]).transposed())
        } else if let Some(z) = self.vector("zaxis")? {
            unit(z).map(shortest_to)
        } else if let Some(euler) = self.vector::<3>("euler")? {
            Some(turns(
                euler.map(|angle| angle * angles.unit),
                angles.sequence,
            ))
        } else {
            Some(Matrix::IDENTITY)
        };
        let zero = || self.element.error("the orientation is zero");
        turn.ok_or_else(zero)
    }
}

/// Turns about moving axes (lower case) or fixed ones (upper case).
fn turns(angles: [f64; 3], sequence: [char; 3]) -> Matrix {
    let mut turn = Matrix::IDENTITY;
    for (angle, axis) in angles.into_iter().zip(sequence) {
        let k = match axis.to_ascii_lowercase() {
            'x' => 0,
            'y' => 1,
            _ => 2,
        };
        let one = Matrix::about(Matrix::IDENTITY.column(k), angle);
        turn = match axis.is_lowercase() {
            true => turn.times(one),
            false => one.times(turn),
        };
    }
    turn
}

/// The rotation by the least angle that turns z along `axis`.
pub(super) fn shortest_to(axis: [f64; 3]) -> Matrix {
    let across = cross([0.0, 0.0, 1.0], axis);
    match unit(across) {
        Some(about) => Matrix::about(about, length(across).atan2(axis[2])),
        None if axis[2] < 0.0 => Matrix::diagonal([1.0, -1.0, -1.0]),
        None => Matrix::IDENTITY,
    }
}
