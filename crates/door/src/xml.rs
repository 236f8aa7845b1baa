//! XML files of which every element and attribute is read, or named with its line.

use crate::error::{DoorError, Part, Result};
use crate::finding::{AT_LIMITS, Effect, Findings, Place};
use crate::pose::{Vector, unit};
use roxmltree::{Document, Node, NodeId, ParsingOptions};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;
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
    findings: Findings,
}

impl TextFile {
    pub(crate) fn new(file: &str, text: &str, findings: &Findings) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            ends: text.match_indices('\n').map(|(byte, _)| byte).collect(),
            shown: None,
            findings: Rc::clone(findings),
        }
    }

    /// Another file of the same model.
    pub(crate) fn beside(&self, file: &str, text: &str) -> Self {
        Self::new(file, text, &self.findings)
    }

    /// The line of a byte, from 1.
    fn line(&self, byte: usize) -> usize {
        1 + self.ends.partition_point(|&end| end < byte)
    }

    pub(crate) fn place(&self, line: usize) -> Place {
        Place {
            file: Arc::clone(&self.file),
            line,
            findings: Rc::clone(&self.findings),
        }
    }

    pub(crate) fn error(&self, span: Range<usize>, message: &str, help: &str) -> DoorError {
        let (mut text, mut span) = (&self.text, span);
        if let Some(shown) = &self.shown {
            let above = shown.split_inclusive('\n').take(self.line(span.start) - 1);
            let start: usize = above.map(str::len).sum();
            let line = shown[start..].lines().next().unwrap_or_default();
            let indentation = line.len() - line.trim_start().len();
            span = start + indentation..start + line.trim_end().len();
            text = shown;
        }
        let mut error = DoorError::new(message, help);
        error.part = Some(Part {
            file: Arc::clone(&self.file),
            text: Arc::clone(text),
            span,
        });
        error
    }

    /// The parsed text. External entities are never read: a document type is refused.
    pub(crate) fn parse(&self) -> Result<Document<'_>> {
        let options = ParsingOptions {
            nodes_limit: 2_000_000,
            ..ParsingOptions::default()
        };
        let xacro = |has: bool| if has { "run xacro first" } else { "" };
        let tree = Document::parse_with_options(&self.text, options).map_err(|error| {
            let above = self.text.split_inclusive('\n');
            let above = above.take(error.pos().row as usize - 1).map(str::len);
            let byte = above.sum::<usize>().min(self.text.len());
            let message = format!("the XML is invalid: {error}");
            self.error(byte..byte, &message, xacro(message.contains("xacro")))
        })?;
        for node in tree.descendants() {
            let start = node.range().start;
            let space = node.tag_name().namespace().unwrap_or_default();
            if space.contains("xacro") {
                let message = "the file has macros of xacro";
                return Err(self.error(start..start + 1, message, xacro(true)));
            }
            if node.ancestors().nth(DEEPEST + 1).is_some() {
                let message = format!("elements are nested deeper than {DEEPEST}");
                return Err(self.error(start..start + 1, &message, ""));
            }
        }
        Ok(tree)
    }
}

/// An element or an attribute: the index of its file, and its first byte there.
type Key = (usize, usize);

/// What was read.
#[derive(Debug, Default)]
struct Ledger {
    read: HashSet<Key>,
    /// Elements that a finding names.
    named: HashSet<Key>,
    /// The elements that give an element its defaults, the nearest first.
    defaults: HashMap<Key, Vec<(usize, NodeId)>>,
    /// By the names of elements the attributes that readers ask for.
    known: HashMap<String, HashSet<String>>,
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

/// What parts that are not read mean, by the names of elements and attributes.
pub(crate) struct Rules {
    /// No motion depends on them.
    pub(crate) idle: &'static str,
    /// They act only at a limit, or where bodies touch.
    pub(crate) limits: &'static str,
}

impl Rules {
    fn effect(&self, name: &str) -> Effect {
        let has = |list: &str| list.split_whitespace().any(|word| word == name);
        match (has(self.idle), has(self.limits)) {
            (true, _) => Effect::Nothing,
            (_, true) => Effect::AtLimits,
            _ => Effect::Changes,
        }
    }
}

/// All XML files of a model.
pub(crate) struct Xml<'t> {
    files: &'t [TextFile],
    trees: &'t [Document<'t>],
    ledger: RefCell<Ledger>,
}

impl<'t> Xml<'t> {
    pub(crate) fn new(files: &'t [TextFile], trees: &'t [Document<'t>]) -> Self {
        Self {
            files,
            trees,
            ledger: RefCell::default(),
        }
    }

    fn element(&self, source: usize, node: Node<'t, 't>) -> Element<'_> {
        Element {
            xml: self,
            source,
            node,
        }
    }

    /// The root of the first file.
    pub(crate) fn root(&self) -> Element<'_> {
        self.element(0, self.trees[0].root_element())
    }

    /// Names what was not read, and counts. What has no effect, or only at limits, shares a finding: with the line of the first.
    pub(crate) fn name_the_rest(&self, rules: &Rules) -> Coverage {
        let mut coverage = Coverage::default();
        let mut shared: BTreeMap<(usize, String, Effect), (usize, usize)> = BTreeMap::new();
        for (source, tree) in self.trees.iter().enumerate() {
            for node in tree.descendants().filter(Node::is_element) {
                let element = self.element(source, node);
                for (effect, attributes) in element.rest(rules, &mut coverage) {
                    if effect == Effect::Changes {
                        let what = format!("{}{attributes}", element.label());
                        element.note(effect, format!("{what}: left out (may change the motion)"));
                        continue;
                    }
                    let what = format!("{}{attributes}", element.tag());
                    let first = (element.place().line, 0);
                    shared.entry((source, what, effect)).or_insert(first).1 += 1;
                }
            }
        }
        for ((source, what, effect), (line, count)) in shared {
            let times = match count {
                1 => String::new(),
                _ => format!(" ({count} times)"),
            };
            let means = match effect {
                Effect::Nothing => "left out, nothing lost",
                _ => AT_LIMITS,
            };
            let text = format!("{what}{times}: {means}");
            self.files[source].place(line).note(effect, text);
        }
        coverage
    }
}

pub(crate) const TRUE: [&str; 2] = ["true", "1"];
pub(crate) const FALSE: [&str; 2] = ["false", "0"];

/// An element of one of the files.
#[derive(Clone, Copy)]
pub(crate) struct Element<'d> {
    xml: &'d Xml<'d>,
    source: usize,
    node: Node<'d, 'd>,
}

impl<'d> Element<'d> {
    /// What of the element was not read: the attributes by their effect, or an empty text for the whole element.
    fn rest(self, rules: &Rules, coverage: &mut Coverage) -> Vec<(Effect, String)> {
        let names: Vec<&str> = self.node.attributes().map(|one| one.name()).collect();
        let all = 1 + names.len();
        coverage.all += all;
        let is_named = self.xml.ledger.borrow().named.contains(&self.key());
        if is_named || !self.is_read() {
            coverage.named += all;
            self.name_all();
            let whole = (rules.effect(self.tag()), String::new());
            return if is_named { Vec::new() } else { vec![whole] };
        }
        let rest = names.into_iter().filter(|name| !self.has_read(name));
        let rest: Vec<&str> = rest.collect();
        coverage.named += rest.len();
        coverage.read += all - rest.len();
        let of = |effect| {
            let those = rest.iter().filter(|name| rules.effect(name) == effect);
            let those: Vec<String> = those.map(|name| format!(" {name}")).collect();
            (effect, those.join(","))
        };
        let all = [Effect::Nothing, Effect::AtLimits, Effect::Changes].map(of);
        let some = all.into_iter().filter(|(_, names)| !names.is_empty());
        some.collect()
    }

    /// Whether an attribute is read. Names are part of every message. A default is read if elements of that name are asked for it, or
    /// for nothing.
    fn has_read(self, name: &str) -> bool {
        let ledger = self.xml.ledger.borrow();
        let start = self.node.attribute_node(name).map(|one| one.range().start);
        let is_default = self.node.ancestors().any(|one| one.has_tag_name("default"));
        let known = ledger.known.get(self.tag());
        name == "name"
            || start.is_some_and(|start| ledger.read.contains(&(self.source, start)))
            || is_default && known.is_none_or(|known| known.contains(name))
    }

    pub(crate) fn tag(&self) -> &'d str {
        self.node.tag_name().name()
    }

    pub(crate) fn place(&self) -> Place {
        let file = &self.xml.files[self.source];
        file.place(file.line(self.node.range().start))
    }

    /// Tag and name, as messages call it.
    pub(crate) fn label(&self) -> String {
        match self.node.attribute("name") {
            Some(name) => format!("{} {name}", self.tag()),
            None => self.tag().to_owned(),
        }
    }

    fn key(&self) -> Key {
        (self.source, self.node.range().start)
    }

    /// The element counts as read.
    pub(crate) fn read(self) -> Self {
        self.xml.ledger.borrow_mut().read.insert(self.key());
        self
    }

    fn is_read(self) -> bool {
        self.xml.ledger.borrow().read.contains(&self.key())
    }

    /// Its child elements; includes are replaced by what they include. It counts as read.
    pub(crate) fn children(self) -> Vec<Self> {
        let mut children = Vec::new();
        for node in self.read().node.children().filter(Node::is_element) {
            let child = Self { node, ..self };
            let file = node.attribute("file").filter(|_| child.tag() == "include");
            let included = |file| self.xml.files.iter().position(|one| &*one.file == file);
            let Some(source) = file.and_then(included) else {
                children.push(child);
                continue;
            };
            let _ = child.attribute("file");
            let node = self.xml.trees[source].root_element();
            let root = self.xml.element(source, node);
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

    /// The first child of this name, which counts as read.
    pub(crate) fn child(self, tag: &str) -> Option<Self> {
        let is = |one: &Node<'_, '_>| one.is_element() && one.tag_name().name() == tag;
        let node = self.node.children().find(is)?;
        Some(Self { node, ..self }.read())
    }

    /// The children of a child.
    pub(crate) fn inner(self, tag: &str) -> Vec<Self> {
        self.child(tag).map(Self::children).unwrap_or_default()
    }

    /// Attributes that the element does not have are those of others, the nearest first.
    pub(crate) fn with_defaults(self, defaults: &[Self]) -> Self {
        let ids = defaults.iter().map(|one| (one.source, one.node.id()));
        let mut ledger = self.xml.ledger.borrow_mut();
        ledger.defaults.insert(self.key(), ids.collect());
        self
    }

    /// An attribute, or its default, which counts as read, as does the element.
    pub(crate) fn attribute(&self, name: &str) -> Option<&'d str> {
        self.read();
        let mut ledger = self.xml.ledger.borrow_mut();
        let known = ledger.known.entry(self.tag().to_owned()).or_default();
        known.insert(name.to_owned());
        let mut all = vec![(self.source, self.node.id())];
        all.extend(ledger.defaults.get(&self.key()).into_iter().flatten());
        all.into_iter().find_map(|(source, id)| {
            let node = self.xml.trees[source].get_node(id)?;
            let attribute = node.attribute_node(name)?;
            ledger.read.insert((source, attribute.range().start));
            Some(attribute.value())
        })
    }

    /// An attribute, or a child with the value as its text or in `value`: formats differ in this.
    pub(crate) fn given(&self, name: &str) -> Option<&'d str> {
        let in_child = || {
            let child = self.child(name)?;
            child.attribute("value").or(Some(child.text()))
        };
        self.attribute(name).or_else(in_child)
    }

    /// Its name, or another.
    pub(crate) fn name_or(&self, other: impl FnOnce() -> String) -> String {
        self.attribute("name").map_or_else(other, str::to_owned)
    }

    /// Its text, which counts as read.
    pub(crate) fn text(self) -> &'d str {
        self.read().node.text().unwrap_or_default().trim()
    }

    pub(crate) fn is(&self, name: &str, value: &str) -> bool {
        self.attribute(name) == Some(value)
    }

    /// Whether an attribute or a child is one of these words.
    pub(crate) fn says(self, name: &str, words: [&str; 2]) -> bool {
        self.given(name).is_some_and(|word| words.contains(&word))
    }

    /// Leaves the element with all inside out.
    pub(crate) fn leave(self, effect: Effect, text: impl Into<String>) {
        self.name_all();
        self.note(effect, text);
    }

    pub(crate) fn note(&self, effect: Effect, text: impl Into<String>) {
        self.place().note(effect, text);
    }

    pub(crate) fn kept(&self, text: impl Into<String>) {
        self.place().kept(text);
    }

    pub(crate) fn lost(&self, what: impl std::fmt::Display) {
        self.place().lost(what);
    }

    fn name_all(&self) {
        let mut ledger = self.xml.ledger.borrow_mut();
        for node in self.node.descendants().filter(Node::is_element) {
            ledger.named.insert((self.source, node.range().start));
        }
    }

    /// An error at the tag.
    pub(crate) fn error(&self, message: impl Into<String>) -> DoorError {
        self.error_with(message, "")
    }

    /// An error at the tag, with what may help.
    pub(crate) fn error_with(&self, message: impl Into<String>, help: &str) -> DoorError {
        let Range { start, end } = self.node.range();
        let file = &self.xml.files[self.source];
        let tag = file.text.get(start..end).and_then(|text| text.find('>'));
        let span = start..start + tag.map_or(1, |end| end + 1);
        file.error(span, &message.into(), help)
    }

    /// The part that a name of the element refers to.
    pub(crate) fn known<T>(&self, part: Option<T>, what: &str, name: &str) -> Result<T> {
        part.ok_or_else(|| self.error(format!("there is no {what} `{name}`")))
    }

    pub(crate) fn unit(&self, axis: Vector) -> Result<Vector> {
        unit(axis).ok_or_else(|| self.error("the axis is zero"))
    }

    /// The numbers of a text that belongs to this element.
    fn parsed(&self, what: &str, text: &str) -> Result<Vec<f64>> {
        let words = text.split(|c: char| c.is_whitespace() || c == ',');
        let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
        let numbers = words.filter(|word| !word.is_empty()).map(number).collect();
        let wrong = || format!("`{what}` of {} has to be numbers: `{text}`", self.label());
        Option::ok_or_else(numbers, || self.error(wrong()))
    }

    /// Exactly `N` numbers.
    pub(crate) fn exactly<const N: usize>(&self, what: &str, text: &str) -> Result<[f64; N]> {
        let numbers = self.parsed(what, text)?;
        let (label, count) = (self.label(), numbers.len());
        let wrong = format!("`{what}` of {label} has {count} numbers in place of {N}");
        numbers.try_into().map_err(|_| self.error(wrong))
    }

    pub(crate) fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>> {
        let text = self.given(name);
        text.map(|text| self.parsed(name, text)).transpose()
    }

    pub(crate) fn vector<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>> {
        let text = self.given(name);
        text.map(|text| self.exactly(name, text)).transpose()
    }

    /// A number, or its default. Of several, which are coefficients of powers, the first.
    pub(crate) fn value(&self, name: &str, default: f64) -> Result<f64> {
        match self.numbers(name)?.as_deref() {
            None => Ok(default),
            Some([first, others @ ..]) => {
                if others.iter().any(|x| *x != 0.0) {
                    let label = self.label();
                    self.lost(format!("{label} {name}: all but the first number"));
                }
                Ok(*first)
            }
            Some([]) => Err(self.error(format!("`{name}` of {} is empty", self.label()))),
        }
    }

    /// A mass of 0 or more.
    pub(crate) fn mass(&self, mass: f64) -> Result<f64> {
        let valid = (mass >= 0.0).then_some(mass);
        valid.ok_or_else(|| self.error("the mass has to be 0 or more"))
    }
}
