//! A machine of several degrees of freedom as plain data.

use crate::machine::LoadDescription;

/// A machine of several degrees of freedom, as plain data.
#[derive(Debug, Clone, PartialEq)]
pub struct SeveralFreedomsDescription {
    /// The name that the names of files and functions begin with.
    pub name: String,
    /// The title of its scene. It may hold any character.
    pub title: String,
    /// The hash of its scene.
    pub scene_hash: String,
    /// The version of the program that exports it.
    pub version: String,
    /// The coordinates.
    pub coordinates: Vec<FreeCoordinate>,
    /// The loads and drives.
    pub loads: Vec<LoadDescription>,
    /// The reactions: name and unit, `N` or `N m`.
    pub reactions: Vec<(String, &'static str)>,
    /// The points whose positions are exported.
    pub points: Vec<String>,
    /// Sentences about the parts of the scene that are not exported.
    pub left_out: Vec<String>,
}

/// A coordinate of a machine of several degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeCoordinate {
    /// Its name.
    pub name: String,
    /// Whether it is an angle (rad); otherwise it is a length (m).
    pub is_angle: bool,
    /// q and q̇ at the start, rad and rad/s, or m and m/s.
    pub initial: [f64; 2],
}

impl SeveralFreedomsDescription {
    /// The number of coordinates.
    pub fn freedoms(&self) -> usize {
        self.coordinates.len()
    }

    /// The pairs of coordinates, i ≤ j.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        let n = self.freedoms();
        let from = |i: usize| (i..n).map(move |j| [i, j]);
        (0..n).flat_map(from).collect()
    }
}
