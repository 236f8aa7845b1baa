//! A record of the layout of a page: its words, and the visible area of each curve. Drawing records it only on
//! request.

use crate::ink::Ink;
use crate::rect::Rect;

/// Words on a page and the box they fill.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The words.
    pub text: String,
    /// Left, top, right and bottom, in pixels; y grows downwards.
    pub area: [f64; 4],
}

/// A named curve or body, with its visible area.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCurve {
    /// Its name.
    pub name: String,
    /// Which of the plots of the page it is in.
    pub plot: usize,
    /// Area that it fills where it is drawn, square pixels.
    pub drawn: f64,
    /// The visible part of this area, square pixels.
    pub visible: f64,
}

/// The layout of a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layout {
    /// Width and height of the page, pixels.
    pub page: [f64; 2],
    /// All words.
    pub labels: Vec<Label>,
    /// The curves with names.
    pub curves: Vec<NamedCurve>,
    /// The names in legends and at the ends of curves, with the plot they belong to.
    pub legend: Vec<(usize, String)>,
    /// Words for which there was no room.
    pub left_out: Vec<String>,
    /// Left, top, right and bottom of all that is drawn, pixels.
    pub drawn: [f64; 4],
}

/// A layout that grows while a canvas draws.
#[derive(Debug)]
pub(crate) struct LayoutRecord {
    layout: Layout,
    plot: usize,
    pub(crate) ink: Ink,
}

impl LayoutRecord {
    /// Of an empty page.
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let page = size.map(f64::from);
        Self {
            layout: Layout {
                page,
                ..Layout::default()
            },
            plot: 0,
            ink: Ink::new(page),
        }
    }

    pub(crate) fn begin_plot(&mut self) {
        self.plot += 1;
    }

    /// Assigns the following ink to a curve of this name, or to none.
    pub(crate) fn begin_curve(&mut self, name: Option<&str>) {
        let Some(name) = name.map(str::trim).filter(|name| !name.is_empty()) else {
            self.ink.owner = None;
            return;
        };
        let curves = &mut self.layout.curves;
        let is_this = |curve: &NamedCurve| curve.plot == self.plot && curve.name == name;
        let index = curves.iter().position(is_this).unwrap_or(curves.len());
        if index == curves.len() {
            curves.push(NamedCurve {
                name: name.to_owned(),
                plot: self.plot,
                drawn: 0.0,
                visible: 0.0,
            });
        }
        self.ink.owner = u16::try_from(index).ok();
    }

    pub(crate) fn legend_entry(&mut self, name: &str) {
        let entry = (self.plot, name.trim().to_owned());
        self.layout.legend.push(entry);
    }

    pub(crate) fn left_out(&mut self, text: &str) {
        self.layout.left_out.push(text.to_owned());
    }

    pub(crate) fn label(&mut self, text: &str, area: Rect) {
        self.layout.labels.push(Label {
            text: text.to_owned(),
            area: [area.x0, area.y0, area.x1, area.y1],
        });
    }

    /// The layout of what has been drawn.
    pub(crate) fn finished(mut self) -> Layout {
        let areas = self.ink.areas(self.layout.curves.len());
        for (curve, [drawn, visible]) in self.layout.curves.iter_mut().zip(areas) {
            (curve.drawn, curve.visible) = (drawn, visible);
        }
        self.layout.drawn = self.ink.extent();
        self.layout
    }
}
