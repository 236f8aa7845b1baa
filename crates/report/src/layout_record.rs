//! What a canvas notes on the layout of a page while it draws.

use crate::ink::{Ink, Owner};
use crate::rect::Rect;

/// What a canvas notes while it draws.
#[derive(Debug)]
pub(crate) struct LayoutRecord {
    /// Words with their boxes.
    pub(crate) labels: Vec<(String, Rect)>,
    /// Curves with the plot they are in.
    pub(crate) curves: Vec<(usize, String)>,
    /// The same of the names in legends.
    pub(crate) legend: Vec<(usize, String)>,
    /// Words for which there was no room.
    pub(crate) left_out: Vec<String>,
    plot: usize,
    pub(crate) ink: Ink,
}

impl LayoutRecord {
    /// Of an empty page.
    pub(crate) fn new([width, height]: [u32; 2]) -> Self {
        Self {
            labels: Vec::new(),
            curves: Vec::new(),
            legend: Vec::new(),
            left_out: Vec::new(),
            plot: 0,
            ink: Ink::new([width, height].map(f64::from)),
        }
    }

    pub(crate) fn begin_plot(&mut self) {
        self.plot += 1;
    }

    /// From now on ink is that of a curve of this name, or of none.
    pub(crate) fn begin_curve(&mut self, name: Option<&str>) {
        let Some(name) = name.map(str::trim).filter(|name| !name.is_empty()) else {
            self.ink.owner = Owner::NOBODY;
            return;
        };
        let curve = (self.plot, name.to_owned());
        let known = self.curves.iter().position(|known| *known == curve);
        let index = known.unwrap_or_else(|| {
            self.curves.push(curve);
            self.curves.len() - 1
        });
        self.ink.owner = Owner::curve(index);
    }

    pub(crate) fn legend_entry(&mut self, name: &str) {
        self.legend.push((self.plot, name.trim().to_owned()));
    }

    pub(crate) fn left_out(&mut self, text: &str) {
        self.left_out.push(text.to_owned());
    }

    pub(crate) fn label(&mut self, text: &str, area: Rect) {
        self.labels.push((text.to_owned(), area));
    }
}
