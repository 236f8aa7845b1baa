//! XML files of which every element and attribute is read, or named with its line.

use crate::error::{DoorError, Part};
use crate::finding::{Effect, Findings, Place};
use crate::pose::{Vector, unit};
use roxmltree::{Attribute, Document, Node, NodeId, ParsingOptions};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// How deep elements may be nested. Readers call themselves for nested bodies.
const DEEPEST: usize = 150;

/// A file and its text.
#[derive(Debug, Clone)]
pub(crate) struct TextFile {
    pub(crate) file: Arc<str>,
    pub(crate) text: Arc<str>,
    /// The last bytes of its lines.
    ends: Vec<usize>,
    /// The text that errors show in place of `text`, with the same lines.
    pub(crate) shown: Option<Arc<str>>,
}

impl TextFile {
    pub(crate) fn new(file: &str, text: &str) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            ends: text.match_indices('\n').map(|(byte, _)| byte).collect(),
            shown: None,
        }
    }

    /// The line of a byte, from 1.
    fn line(&self, byte: usize) -> usize {
        1 + self.ends.partition_point(|&end| end < byte)
    }

    pub(crate) fn place(&self, line: usize) -> Place {
        Place {
            file: Arc::clone(&self.file),
            line,
        }
    }

    pub(crate) fn error(&self, span: (usize, usize), message: String, help: &str) -> DoorError {
        let mut text = Arc::clone(&self.text);
        let mut span = span;
        if let Some(shown) = &self.shown {
            // The line, without its indentation.
            let lines = shown.split_inclusive('\n');
            let start = lines
                .clone()
                .take(self.line(span.0) - 1)
                .map(str::len)
                .sum::<usize>();
            let line = lines.clone().nth(self.line(span.0) - 1).unwrap_or_default();
            span = (
                start + line.len() - line.trim_start().len(),
                line.trim().len(),
            );
            text = Arc::clone(shown);
        }
        DoorError::Part(Box::new(Part {
            message,
            help: help.to_owned(),
            file: Arc::clone(&self.file),
            text,
            span,
        }))
    }

    /// The parsed text. External entities are never read: a document type is refused.
    pub(crate) fn parse(&self) -> Result<Document<'_>, DoorError> {
        let options = ParsingOptions {
            nodes_limit: 2_000_000,
            ..ParsingOptions::default()
        };
        let tree = Document::parse_with_options(&self.text, options).map_err(|error| {
            let at = error.pos();
            let start = self.text.split_inclusive('\n').take(at.row as usize - 1);
            let byte = start.map(str::len).sum::<usize>().min(self.text.len());
            let message = format!("the XML is invalid: {error}");
            let help = if message.contains("xacro") {
                "run xacro first"
            } else {
                ""
            };
            self.error((byte, 0), message, help)
        })?;
        let mut depth: HashMap<NodeId, usize> = HashMap::new();
        for node in tree.root().descendants() {
            let above = node.parent().and_then(|parent| depth.get(&parent.id()));
            let here = above.map_or(0, |above| above + 1);
            if here > DEEPEST {
                let message = format!("elements are nested deeper than {DEEPEST}");
                return Err(self.error((node.range().start, 1), message, ""));
            }
            depth.insert(node.id(), here);
        }
        Ok(tree)
    }
}

/// What was read, by the first bytes of elements and attributes in their file.
#[derive(Debug, Default)]
struct Ledger {
    read: HashSet<(usize, usize)>,
    named: HashSet<(usize, usize)>,
    /// Elements and attributes that a reader has asked for.
    known: HashSet<(String, String)>,
}

/// How many elements and attributes a file has, and what became of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Coverage {
    /// Elements and attributes of the files. In a file without XML: its lines, or its fields.
    pub all: usize,
    /// Those that the reader took.
    pub read: usize,
    /// Those that a finding names.
    pub named: usize,
}

/// All XML files of a model.
pub(crate) struct Xml<'t> {
    files: &'t [TextFile],
    trees: &'t [Document<'t>],
    ledger: RefCell<Ledger>,
    pub(crate) findings: Findings,
}

/// What parts that are not read mean, by the names of elements and attributes.
pub(crate) struct Rules {
    /// No motion depends on them.
    pub(crate) idle: &'static str,
    /// They act only at a limit, or where bodies touch.
    pub(crate) limits: &'static str,
}

impl Rules {
    pub(crate) fn effect(&self, name: &str) -> Effect {
        let has = |list: &str| list.split_whitespace().any(|word| word == name);
        match (has(self.idle), has(self.limits)) {
            (true, _) => Effect::Nothing,
            (_, true) => Effect::AtLimits,
            _ => Effect::Changes,
        }
    }
}

impl<'t> Xml<'t> {
    pub(crate) fn new(
        files: &'t [TextFile],
        trees: &'t [Document<'t>],
        findings: Findings,
    ) -> Self {
        Self {
            files,
            trees,
            ledger: RefCell::default(),
            findings,
        }
    }

    pub(crate) fn root(&self, source: usize) -> Element<'_> {
        let node = self.trees[source].root_element();
        Element {
            xml: self,
            source,
            node,
        }
    }

    /// The index of an included file.
    pub(crate) fn included(&self, file: &str) -> Option<usize> {
        self.files.iter().position(|one| &*one.file == file)
    }

    /// Names what was not read, and counts.
    pub(crate) fn name_the_rest(&self, rules: &Rules) -> Coverage {
        let mut coverage = Coverage::default();
        for (source, tree) in self.trees.iter().enumerate() {
            let mut idle = Idle::new();
            for node in tree.root().descendants().filter(Node::is_element) {
                let xml = self;
                self.name(
                    Element { xml, source, node },
                    rules,
                    &mut coverage,
                    &mut idle,
                );
            }
            for (what, (line, effect, count)) in idle {
                let times = if count > 1 {
                    format!(" ({count} times)")
                } else {
                    String::new()
                };
                let means = if effect == Effect::Nothing {
                    "left out, nothing lost"
                } else {
                    AT_LIMITS
                };
                let place = self.files[source].place(line);
                self.findings
                    .add(&place, effect, format!("{what}{times}: {means}"));
            }
        }
        coverage
    }

    fn name(&self, element: Element<'_>, rules: &Rules, coverage: &mut Coverage, idle: &mut Idle) {
        let attributes: Vec<_> = element.node.attributes().collect();
        coverage.all += 1 + attributes.len();
        if self.ledger.borrow().named.contains(&element.key()) {
            coverage.named += 1 + attributes.len();
            return;
        }
        if !element.is_read() {
            coverage.named += 1 + attributes.len();
            element.name_all();
            return element.left_out(rules.effect(element.tag()), "", idle);
        }
        // Names are part of every message.
        let is_read = |one: &Attribute<'_, '_>| {
            let key = (element.source, one.range().start);
            one.name() == "name" || self.ledger.borrow().read.contains(&key)
        };
        let rest = attributes.iter().filter(|one| !is_read(one));
        let rest: Vec<&str> = rest.map(|one| one.name()).collect();
        coverage.read += 1 + attributes.len() - rest.len();
        coverage.named += rest.len();
        for effect in [Effect::Nothing, Effect::AtLimits, Effect::Changes] {
            let those = rest.iter().filter(|name| rules.effect(name) == effect);
            let names: Vec<_> = those.copied().collect();
            if !names.is_empty() {
                element.left_out(effect, &format!(" {}", names.join(", ")), idle);
            }
        }
    }
}

/// Parts without effect, or only at limits, share a finding: the line of the first, and how many there are.
type Idle = BTreeMap<String, (usize, Effect, usize)>;

/// What becomes of parts that act only at a limit, and of parts that change the motion.
pub(crate) const AT_LIMITS: &str = "left out (acts only at a limit)";
pub(crate) const NO_GRAVITY: &str = "no gravity in the file: 9.81 m/s2 against z";
pub(crate) const LOST: &str = "left out (changes the motion)";

/// An element of one of the files.
#[derive(Clone, Copy)]
pub(crate) struct Element<'d> {
    xml: &'d Xml<'d>,
    source: usize,
    node: Node<'d, 'd>,
}

impl<'d> Element<'d> {
    pub(crate) fn tag(&self) -> &'d str {
        self.node.tag_name().name()
    }

    pub(crate) fn line(&self) -> usize {
        self.xml.files[self.source].line(self.node.range().start)
    }

    pub(crate) fn place(&self) -> Place {
        self.xml.files[self.source].place(self.line())
    }

    /// Tag and name, as messages call it.
    pub(crate) fn label(&self) -> String {
        match self.node.attribute("name") {
            Some(name) => format!("{} {name}", self.tag()),
            None => self.tag().to_owned(),
        }
    }

    /// Its file and its first byte there.
    fn key(&self) -> (usize, usize) {
        (self.source, self.node.range().start)
    }

    /// The element counts as read.
    pub(crate) fn read(self) -> Self {
        self.xml.ledger.borrow_mut().read.insert(self.key());
        self
    }

    fn left_out(&self, effect: Effect, attributes: &str, idle: &mut Idle) {
        let what = match effect {
            Effect::Kept | Effect::Changes => {
                let text = format!(
                    "{}{attributes}: left out (may change the motion)",
                    self.label()
                );
                return self.note(effect, text);
            }
            _ => format!("{}{attributes}", self.tag()),
        };
        let (_, _, count) = idle.entry(what).or_insert((self.line(), effect, 0));
        *count += 1;
    }

    /// Its child elements; includes are replaced by what they include. It counts as read.
    pub(crate) fn children(self) -> Vec<Self> {
        let mut children = Vec::new();
        for node in self.read().node.children().filter(Node::is_element) {
            let child = Self { node, ..self };
            let file = node.attribute("file").filter(|_| child.tag() == "include");
            let Some(source) = file.and_then(|file| self.xml.included(file)) else {
                children.push(child);
                continue;
            };
            let _ = child.attribute("file");
            let root = self.xml.root(source);
            // Each file is included once.
            if !root.is_read() {
                children.extend(root.children());
            }
        }
        children
    }

    /// The children of this name, which count as read.
    pub(crate) fn called(self, tag: &str) -> Vec<Self> {
        let children = self.children().into_iter().filter(|one| one.tag() == tag);
        children.map(Self::read).collect()
    }

    fn is_read(self) -> bool {
        self.xml.ledger.borrow().read.contains(&self.key())
    }

    /// The children of a child.
    pub(crate) fn inner(self, tag: &str) -> Vec<Self> {
        self.child(tag).map(Self::children).unwrap_or_default()
    }

    /// Its name, or another.
    pub(crate) fn name_or(&self, other: impl FnOnce() -> String) -> String {
        self.attribute("name").map_or_else(other, str::to_owned)
    }

    /// The first child of this name, which counts as read.
    pub(crate) fn child(self, tag: &str) -> Option<Self> {
        let is = |one: &Node<'_, '_>| one.is_element() && one.tag_name().name() == tag;
        let node = self.node.children().find(is)?;
        Some(Self { node, ..self }.read())
    }

    /// An attribute, which counts as read, as does the element.
    pub(crate) fn attribute(&self, name: &str) -> Option<&'d str> {
        self.read();
        let mut ledger = self.xml.ledger.borrow_mut();
        ledger
            .known
            .insert((self.tag().to_owned(), name.to_owned()));
        let attribute = self.node.attribute_node(name)?;
        ledger.read.insert((self.source, attribute.range().start));
        Some(attribute.value())
    }

    /// Whether a reader asks elements of this name for this attribute, or never asks them for anything.
    pub(crate) fn is_known(&self, attribute: &str) -> bool {
        let ledger = self.xml.ledger.borrow();
        let tag = self.tag();
        ledger
            .known
            .contains(&(tag.to_owned(), attribute.to_owned()))
            || !ledger.known.iter().any(|(one, _)| one == tag)
    }

    /// The names of its attributes.
    pub(crate) fn names(&self) -> Vec<&'d str> {
        self.node.attributes().map(|one| one.name()).collect()
    }

    /// Its text, which counts as read.
    pub(crate) fn text(self) -> &'d str {
        self.read().node.text().unwrap_or_default().trim()
    }

    /// The text of a child.
    pub(crate) fn child_text(self, tag: &str) -> Option<&'d str> {
        self.child(tag).map(Self::text)
    }

    /// Leaves the element with all inside out.
    pub(crate) fn leave(self, effect: Effect, text: impl Into<String>) {
        self.name_all();
        self.note(effect, text);
    }

    pub(crate) fn note(&self, effect: Effect, text: impl Into<String>) {
        self.xml.findings.add(&self.place(), effect, text);
    }

    pub(crate) fn kept(&self, text: impl Into<String>) {
        self.note(Effect::Kept, text);
    }

    /// Something of the element that changes the motion is left out.
    pub(crate) fn lost(&self, what: impl std::fmt::Display) {
        self.note(Effect::Changes, format!("{what}: {LOST}"));
    }

    fn name_all(&self) {
        let mut ledger = self.xml.ledger.borrow_mut();
        for node in self.node.descendants().filter(Node::is_element) {
            ledger.named.insert((self.source, node.range().start));
        }
    }

    pub(crate) fn error(&self, message: impl Into<String>) -> DoorError {
        self.error_with(message, "")
    }

    /// An error at the tag, with what may help.
    pub(crate) fn error_with(&self, message: impl Into<String>, help: &str) -> DoorError {
        let range = self.node.range();
        let file = &self.xml.files[self.source];
        let tag = file.text.get(range.clone()).and_then(|text| text.find('>'));
        let span = (range.start, tag.map_or(1, |end| end + 1));
        file.error(span, message.into(), help)
    }

    /// The part that a name of the element refers to.
    pub(crate) fn known<T>(&self, part: Option<T>, what: &str, name: &str) -> Result<T, DoorError> {
        part.ok_or_else(|| self.error(format!("there is no {what} `{name}`")))
    }

    pub(crate) fn unit(&self, axis: Vector) -> Result<Vector, DoorError> {
        unit(axis).ok_or_else(|| self.error("the axis is zero"))
    }

    /// The numbers of a text that belongs to this element.
    pub(crate) fn numbers(&self, what: &str, text: &str) -> Result<Vec<f64>, DoorError> {
        let words = text.split(|c: char| c.is_whitespace() || c == ',');
        let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
        let numbers = words.filter(|word| !word.is_empty()).map(number).collect();
        let wrong = || format!("`{what}` of {} has to be numbers: `{text}`", self.label());
        Option::ok_or_else(numbers, || self.error(wrong()))
    }

    /// Exactly `N` numbers.
    pub(crate) fn exactly<const N: usize>(
        &self,
        what: &str,
        text: &str,
    ) -> Result<[f64; N], DoorError> {
        let numbers = self.numbers(what, text)?;
        let (label, count) = (self.label(), numbers.len());
        let wrong = format!("`{what}` of {label} has {count} numbers in place of {N}");
        numbers.try_into().map_err(|_| self.error(wrong))
    }

    /// An attribute of `N` numbers.
    pub(crate) fn vector<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, DoorError> {
        let text = self.attribute(name);
        text.map(|text| self.exactly(name, text)).transpose()
    }

    /// An attribute of a number, or its default.
    pub(crate) fn value(&self, name: &str, default: f64) -> Result<f64, DoorError> {
        Ok(self.vector::<1>(name)?.map_or(default, |[x]| x))
    }

    /// `N` numbers in a child.
    pub(crate) fn child_vector<const N: usize>(
        self,
        tag: &str,
    ) -> Result<Option<[f64; N]>, DoorError> {
        let child = self.child(tag);
        child.map(|one| one.exactly(tag, one.text())).transpose()
    }

    /// The number in a child, or its default.
    pub(crate) fn child_value(self, tag: &str, default: f64) -> Result<f64, DoorError> {
        Ok(self.child_vector::<1>(tag)?.map_or(default, |[x]| x))
    }

    /// Whether a child says that something is so.
    pub(crate) fn says(self, tag: &str) -> bool {
        self.child_text(tag)
            .is_some_and(|word| word == "true" || word == "1")
    }

    /// A mass of 0 or more.
    pub(crate) fn mass(&self, mass: f64) -> Result<f64, DoorError> {
        let valid = (mass >= 0.0).then_some(mass);
        valid.ok_or_else(|| self.error("the mass has to be 0 or more"))
    }
}
