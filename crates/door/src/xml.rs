//! XML files of which every element and attribute is read, or named with its line.

use crate::error::{DoorError, Part};
use crate::finding::{Effect, Findings, Place};
use roxmltree::{Document, Node, NodeId, ParsingOptions};
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
}

impl TextFile {
    pub(crate) fn new(file: &str, text: &str) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            ends: text.match_indices('\n').map(|(byte, _)| byte).collect(),
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
        DoorError::Part(Box::new(Part {
            message,
            help: help.to_owned(),
            file: Arc::clone(&self.file),
            text: Arc::clone(&self.text),
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
            self.error((byte, 0), format!("the XML is invalid: {error}"), "")
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

/// The sentence for parts without effect.
pub(crate) fn left_out(what: &str, count: usize) -> String {
    let times = if count > 1 {
        format!(" ({count} times)")
    } else {
        String::new()
    };
    format!("{what}{times}: left out, nothing lost")
}

/// All XML files of a model.
pub(crate) struct Xml<'t> {
    files: &'t [TextFile],
    trees: &'t [Document<'t>],
    ledger: RefCell<Ledger>,
    pub(crate) findings: Findings,
}

/// The reason why something that was not read is left out: what it means, and a word for the reader.
pub(crate) type Judge = fn(&Element<'_>, Option<&str>) -> Effect;

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
    pub(crate) fn name_the_rest(&self, judge: Judge) -> Coverage {
        let mut coverage = Coverage::default();
        for source in 0..self.trees.len() {
            self.name_in(source, judge, &mut coverage);
        }
        coverage
    }

    fn name_in(&self, source: usize, judge: Judge, coverage: &mut Coverage) {
        // Parts without effect share a finding: their first line, and how often they occur.
        let mut idle: BTreeMap<String, (usize, usize)> = BTreeMap::new();
        let nodes = self.trees[source].root().descendants();
        for node in nodes.filter(Node::is_element) {
            let element = Element {
                xml: self,
                source,
                node,
            };
            let attributes: Vec<_> = node
                .attributes()
                .map(|one| (one.name(), one.range().start))
                .collect();
            coverage.all += 1 + attributes.len();
            let is = |set: &HashSet<(usize, usize)>, byte| set.contains(&(source, byte));
            let ledger = self.ledger.borrow();
            if is(&ledger.named, node.range().start) {
                coverage.named += 1 + attributes.len();
                continue;
            }
            if !is(&ledger.read, node.range().start) {
                drop(ledger);
                let effect = judge(&element, None);
                let what = element.label();
                element.name_all();
                coverage.named += 1 + attributes.len();
                self.report(&element, effect, what, &mut idle);
                continue;
            }
            coverage.read += 1;
            let (read, rest): (Vec<_>, Vec<_>) = attributes
                .into_iter()
                .partition(|(_, byte)| is(&ledger.read, *byte));
            drop(ledger);
            coverage.read += read.len();
            coverage.named += rest.len();
            for effect in [Effect::Nothing, Effect::AtLimits, Effect::Changes] {
                let those = rest
                    .iter()
                    .filter(|(name, _)| judge(&element, Some(name)) == effect);
                let names: Vec<_> = those.map(|(name, _)| *name).collect();
                if !names.is_empty() {
                    let of = if effect == Effect::Nothing {
                        element.tag().to_owned()
                    } else {
                        element.label()
                    };
                    self.report(
                        &element,
                        effect,
                        format!("{of} {}", names.join(", ")),
                        &mut idle,
                    );
                }
            }
        }
        for (what, (line, count)) in idle {
            let text = left_out(&what, count);
            self.findings
                .add(&self.files[source].place(line), Effect::Nothing, text);
        }
    }

    fn report(
        &self,
        element: &Element<'_>,
        effect: Effect,
        what: String,
        idle: &mut BTreeMap<String, (usize, usize)>,
    ) {
        let text = match effect {
            Effect::Nothing => {
                let what = if what == element.label() {
                    element.tag().to_owned()
                } else {
                    what
                };
                idle.entry(what).or_insert((element.line(), 0)).1 += 1;
                return;
            }
            Effect::AtLimits => format!("{what}: left out (acts only at a limit)"),
            Effect::Kept | Effect::Changes => format!("{what}: left out (may change the motion)"),
        };
        self.findings.add(&element.place(), effect, text);
    }
}

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

    pub(crate) fn parent(&self) -> Option<Self> {
        let node = self.node.parent_element()?;
        Some(Self { node, ..*self })
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

    /// The element counts as read.
    pub(crate) fn read(self) -> Self {
        let byte = (self.source, self.node.range().start);
        self.xml.ledger.borrow_mut().read.insert(byte);
        self
    }

    /// Its child elements; includes are replaced by what they include. It counts as read.
    pub(crate) fn children(self) -> Vec<Self> {
        self.read();
        let mut children = Vec::new();
        for node in self.node.children().filter(Node::is_element) {
            let child = Self { node, ..self };
            match child
                .node
                .attribute("file")
                .filter(|_| child.tag() == "include")
            {
                Some(file) if self.xml.included(file).is_some() => {
                    let _ = child.attribute("file");
                    let source = self.xml.included(file).unwrap_or_default();
                    let root = self.xml.root(source);
                    // Each file is included once.
                    if !root.is_read() {
                        children.extend(root.children());
                    }
                }
                _ => children.push(child),
            }
        }
        children
    }

    fn is_read(self) -> bool {
        let byte = (self.source, self.node.range().start);
        self.xml.ledger.borrow().read.contains(&byte)
    }

    /// The first child of this name, which counts as read.
    pub(crate) fn child(self, tag: &str) -> Option<Self> {
        let children = self.node.children();
        let node = children
            .into_iter()
            .find(|one| one.is_element() && one.tag_name().name() == tag)?;
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

    fn name_all(&self) {
        let mut ledger = self.xml.ledger.borrow_mut();
        for node in self.node.descendants().filter(Node::is_element) {
            ledger.named.insert((self.source, node.range().start));
        }
    }

    pub(crate) fn error(&self, message: impl Into<String>, help: &str) -> DoorError {
        let range = self.node.range();
        let file = &self.xml.files[self.source];
        // The tag, not all that it holds.
        let tag = file.text.get(range.clone()).and_then(|text| text.find('>'));
        let span = (range.start, tag.map_or(1, |end| end + 1));
        file.error(span, message.into(), help)
    }

    /// The numbers of a text that belongs to this element.
    pub(crate) fn numbers(&self, what: &str, text: &str) -> Result<Vec<f64>, DoorError> {
        let words = text.split(|c: char| c.is_whitespace() || c == ',');
        let number = |word: &str| word.parse::<f64>().ok().filter(|x| x.is_finite());
        let numbers: Option<Vec<f64>> = words.filter(|word| !word.is_empty()).map(number).collect();
        numbers.ok_or_else(|| {
            self.error(
                format!("`{what}` of {} has to be numbers: `{text}`", self.label()),
                "",
            )
        })
    }

    /// Exactly `N` numbers.
    pub(crate) fn exactly<const N: usize>(
        &self,
        what: &str,
        text: &str,
    ) -> Result<[f64; N], DoorError> {
        let numbers = self.numbers(what, text)?;
        let count = numbers.len();
        let wrong = |_| {
            self.error(
                format!(
                    "`{what}` of {} has {count} numbers in place of {N}",
                    self.label()
                ),
                "",
            )
        };
        numbers.try_into().map_err(wrong)
    }

    /// An attribute of `N` numbers.
    pub(crate) fn vector<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, DoorError> {
        self.attribute(name)
            .map(|text| self.exactly(name, text))
            .transpose()
    }

    pub(crate) fn number(&self, name: &str) -> Result<Option<f64>, DoorError> {
        Ok(self.vector::<1>(name)?.map(|[x]| x))
    }

    /// The number in a child.
    pub(crate) fn child_number(self, tag: &str) -> Result<Option<f64>, DoorError> {
        let child = self.child(tag);
        child
            .map(|one| Ok(one.exactly::<1>(tag, one.text())?[0]))
            .transpose()
    }
}
