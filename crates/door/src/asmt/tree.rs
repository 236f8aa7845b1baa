//! The lines of a file as a tree, of which every line is read or named.

use crate::error::DoorError;
use crate::finding::{Effect, Findings, Place};
use crate::pose::{Matrix, Pose, Vector};
use crate::xml::{Coverage, TextFile, left_out};
use std::cell::RefCell;
use std::collections::BTreeMap;

struct Line<'t> {
    text: &'t str,
    depth: usize,
    number: usize,
    /// Its first byte in the file.
    byte: usize,
    /// The line after those below it.
    end: usize,
}

pub(super) struct Tree<'t> {
    file: &'t TextFile,
    lines: Vec<Line<'t>>,
    read: RefCell<Vec<bool>>,
    findings: Findings,
}

#[derive(Clone, Copy)]
pub(super) struct Node<'t> {
    tree: &'t Tree<'t>,
    line: usize,
}

impl<'t> Tree<'t> {
    pub(super) fn new(file: &'t TextFile, findings: Findings) -> Result<Self, DoorError> {
        let mut lines: Vec<Line<'t>> = Vec::new();
        let mut byte = 0;
        for (number, text) in file.text.split_inclusive('\n').enumerate() {
            if !text.trim().is_empty() {
                lines.push(Line {
                    text: text.trim(),
                    depth: text.len() - text.trim_start_matches('\t').len(),
                    number: number + 1,
                    byte,
                    end: 0,
                });
            }
            byte += text.len();
        }
        let mut open: Vec<usize> = Vec::new();
        for line in 0..lines.len() {
            while let Some(&above) = open
                .last()
                .filter(|above| lines[**above].depth >= lines[line].depth)
            {
                lines[above].end = line;
                open.pop();
            }
            open.push(line);
        }
        let count = lines.len();
        open.into_iter().for_each(|above| lines[above].end = count);
        Ok(Self {
            file,
            read: RefCell::new(vec![false; count]),
            lines,
            findings,
        })
    }

    pub(super) fn roots(&'t self) -> Vec<Node<'t>> {
        self.between(0, self.lines.len())
    }

    /// The lines of a range that are below no other of it.
    fn between(&'t self, mut line: usize, end: usize) -> Vec<Node<'t>> {
        let mut nodes = Vec::new();
        while line < end {
            nodes.push(Node { tree: self, line });
            line = self.lines[line].end;
        }
        nodes
    }

    /// Names the lines that were not read, each with all below it.
    pub(super) fn name_the_rest(&self, idle_names: &[&str]) -> Coverage {
        let read = self.read.borrow();
        let mut coverage = Coverage {
            all: self.lines.len(),
            ..Coverage::default()
        };
        // Parts without effect share a finding.
        let mut idle: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        let mut line = 0;
        while line < self.lines.len() {
            let of = &self.lines[line];
            if read[line] {
                coverage.read += 1;
                line += 1;
                continue;
            }
            // What was read below it counts as read.
            coverage.named += (line..of.end).filter(|k| !read[*k]).count();
            coverage.read += (line..of.end).filter(|k| read[*k]).count();
            if idle_names.contains(&of.text) {
                idle.entry(of.text).or_insert((of.number, 0)).1 += 1;
            } else {
                let what = of.text.chars().take(80).collect::<String>();
                let text = format!("{what}: left out (may change the motion)");
                self.findings
                    .add(&self.file.place(of.number), Effect::Changes, text);
            }
            line = of.end;
        }
        for (what, (number, count)) in idle {
            let text = left_out(what, count);
            self.findings
                .add(&self.file.place(number), Effect::Nothing, text);
        }
        coverage
    }
}

impl<'t> Node<'t> {
    pub(super) fn text(self) -> &'t str {
        self.tree.lines[self.line].text
    }

    pub(super) fn read(self) -> Self {
        self.tree.read.borrow_mut()[self.line] = true;
        self
    }

    pub(super) fn place(self) -> Place {
        self.tree.file.place(self.tree.lines[self.line].number)
    }

    /// The lines one level below; it counts as read.
    pub(super) fn children(self) -> Vec<Self> {
        self.read();
        self.tree
            .between(self.line + 1, self.tree.lines[self.line].end)
    }

    /// The child of this text, which counts as read.
    pub(super) fn child(self, key: &str) -> Option<Self> {
        self.children()
            .into_iter()
            .find(|child| child.text() == key)
            .map(Self::read)
    }

    /// The text below the child of this name.
    pub(super) fn value(self, key: &str) -> String {
        let lines = self.child(key).map(Self::children).unwrap_or_default();
        let texts: Vec<&str> = lines.into_iter().map(|line| line.read().text()).collect();
        texts.join(" ")
    }

    pub(super) fn error(self, message: &str) -> DoorError {
        let line = &self.tree.lines[self.line];
        self.tree.file.error(
            (line.byte + line.depth, line.text.len()),
            message.to_owned(),
            "",
        )
    }

    /// The numbers of the lines below; their floats may end with `d`.
    pub(super) fn numbers<const N: usize>(self) -> Result<[f64; N], DoorError> {
        let lines = self.children();
        let words = lines
            .iter()
            .flat_map(|line| line.read().text().split_whitespace());
        let number = |word: &str| {
            word.trim_end_matches('d')
                .parse::<f64>()
                .ok()
                .filter(|x| x.is_finite())
        };
        let numbers: Option<Vec<f64>> = words.map(number).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.ok_or_else(|| self.error(&format!("`{}` has to be {N} numbers", self.text())))
    }

    pub(super) fn vector(self) -> Result<Vector, DoorError> {
        self.numbers()
    }

    /// Its position and rotation.
    pub(super) fn pose(self) -> Result<Pose, DoorError> {
        let origin = self
            .child("Position3D")
            .map(Self::vector)
            .transpose()?
            .unwrap_or_default();
        let Some(rotation) = self.child("RotationMatrix") else {
            return Ok(Pose::at(origin));
        };
        let [a, b, c, d, e, f, g, h, i] = rotation.numbers()?;
        let turn = Matrix([[a, b, c], [d, e, f], [g, h, i]]);
        if turn.rotation_error() > 1e-6 {
            return Err(rotation.error("the matrix is no rotation"));
        }
        Ok(Pose { origin, turn })
    }
}
