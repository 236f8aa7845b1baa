"""One build for all changes: a copy of the sources in which every changed expression is chosen while the program runs.

`a + b` becomes `(if crate::mutant::on(17) { a - b } else { a + b })`. Changes that do not compile are left out; they are found from
the positions of the compiler errors.
"""
import json
import os
import shutil
import subprocess

MODULE = '''
//! Which change is active: that of the variable DWELL_MUTANT. Where DWELL_MUTANT_REACHED names a file, none is, and the number of
//! every change that is reached is added to the file.
use std::io::Write as _;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

const NOT_READ: u32 = u32::MAX;
const RECORDING: u32 = u32::MAX - 1;
static ACTIVE: AtomicU32 = AtomicU32::new(NOT_READ);
static REACHED: [AtomicU64; 256] = [const { AtomicU64::new(0) }; 256];

#[inline]
pub(crate) fn on(number: u32) -> bool {
    let active = ACTIVE.load(Relaxed);
    if active == number { true } else if active < RECORDING { false } else { first(number) }
}

#[cold]
#[inline(never)]
fn first(number: u32) -> bool {
    if ACTIVE.load(Relaxed) == NOT_READ {
        let chosen = std::env::var("DWELL_MUTANT").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
        let is_recording = std::env::var_os("DWELL_MUTANT_REACHED").is_some();
        ACTIVE.store(if is_recording { RECORDING } else { chosen }, Relaxed);
        return on(number);
    }
    // Another thread may have read the variables since `on` looked.
    if ACTIVE.load(Relaxed) < RECORDING { return on(number); }
    let bit = 1_u64 << (number % 64);
    if REACHED[number as usize / 64].fetch_or(bit, Relaxed) & bit == 0 {
        let file = std::env::var_os("DWELL_MUTANT_REACHED").expect("a file");
        let mut file = std::fs::OpenOptions::new().append(true).create(true).open(file).expect("it opens");
        file.write_all(format!("{number}\\n").as_bytes()).expect("it is written");
    }
    false
}
'''
COPIED = ["Cargo.toml", "Cargo.lock", "clippy.toml", "crates", "tests", "validation", "docs"]
MOST_NUMBERS = 256 * 64
MOST_ROUNDS = 60


class Region:
    """An expression with its changes and its subexpressions."""

    def __init__(self, start, end):
        self.start, self.end, self.changes, self.inner = start, end, [], []


def regions(changes):
    """The changed expressions of a file as a tree. Changes that overlap others only in part are left out."""
    by_extent = {}
    for change in changes:
        by_extent.setdefault((change.start, change.end), []).append(change)
    top, open_ones = [], []
    for (start, end), of in sorted(by_extent.items(), key=lambda item: (item[0][0], -item[0][1])):
        while open_ones and open_ones[-1].end <= start:
            open_ones.pop()
        if open_ones and open_ones[-1].end < end:
            continue
        region = Region(start, end)
        region.changes = of
        (open_ones[-1].inner if open_ones else top).append(region)
        open_ones.append(region)
    return top


class Rendered:
    """A file with inserted choices, and the byte ranges of the changes and choices."""

    def __init__(self, text, changes):
        self.pieces, self.at = [], 0
        self.branches, self.choices = [], []
        self.text = text
        self._part(0, len(text), regions(changes))

    def _add(self, text):
        self.pieces.append(text)
        self.at += len(text.encode())

    def _part(self, start, end, inner):
        for region in inner:
            self._add(self.text[start : region.start])
            self._choice(region)
            start = region.end
        self._add(self.text[start:end])

    def _choice(self, region):
        begin = self.at
        self._add("(")
        for change in region.changes:
            self._add(f"if crate::mutant::on({change.number}) {{ ")
            branch = self.at
            self._add(change.text)
            self.branches.append((branch, self.at, [change]))
            self._add(" } else ")
        self._add("{ ")
        self._part(region.start, region.end, region.inner)
        self._add(" })")
        self.choices.append((begin, self.at, region.changes))

    def written(self):
        return "".join(self.pieces)

    def blamed(self, start, end):
        """The changes to which an error at these bytes is attributed."""
        around = lambda ones: [one for one in ones if one[0] <= start and end <= one[1]]
        smallest = lambda ones: min(ones, key=lambda one: one[1] - one[0])[2]
        if found := around(self.branches):
            return smallest(found)
        if found := around(self.choices):
            return smallest(found)
        return [change for a, b, of in self.choices if start <= a and b <= end for change in of]


class Build:
    """The copy of the source tree, and the program built from it."""

    def __init__(self, top, folder, changes):
        self.top, self.folder, self.changes = top, folder, changes
        self.tree, self.target = folder / "tree", folder / "build"
        self.left_out = []

    def program(self):
        return self.target / "release" / "dwell"

    def run(self, say):
        """Builds; changes that do not compile go to `left_out`."""
        if len(self.changes) >= MOST_NUMBERS:
            raise SystemExit(f"{len(self.changes)} changes are too many for one build")
        for number, change in enumerate(self.changes, 1):
            change.number = number
        self._copy(self._render())
        for attempt in range(MOST_ROUNDS):
            rendered = self._render()
            errors = self._compile()
            if errors is None:
                say(f"built: {len(self.changes)} changes compile, {len(self.left_out)} do not")
                return
            blamed = {id(change): change for error in errors for change in self._blamed(error, rendered)}
            if not blamed:
                raise SystemExit("the copy does not compile, and no change is at fault:\n" + "\n".join(e["rendered"] for e in errors[:5]))
            say(f"round {attempt + 1}: {len(blamed)} changes do not compile")
            for change in blamed.values():
                if change.named:
                    raise SystemExit(f"the named fault `{change.what}` does not compile:\n" + "\n".join(e["rendered"] for e in errors[:8]))
            self.left_out += blamed.values()
            self.changes = [change for change in self.changes if id(change) not in blamed]
        raise SystemExit(f"after {MOST_ROUNDS} rounds the copy does not compile")

    def _copy(self, rendered):
        """Copies all files that are not rendered. Unchanged files keep their times, so that they are not compiled again."""
        for name in COPIED:
            source, copy = self.top / name, self.tree / name
            for path in sorted(source.rglob("*")) if source.is_dir() else [source]:
                name = path.relative_to(self.top)
                if path.is_file() and name.as_posix() not in rendered and "__pycache__" not in name.parts:
                    write_if_new(self.tree / name, path.read_bytes())
            for path in sorted(copy.rglob("*"), reverse=True) if copy.is_dir() else []:
                if not (self.top / path.relative_to(self.tree)).exists():
                    shutil.rmtree(path) if path.is_dir() else path.unlink()
        for root in self._roots():
            write_if_new((self.tree / root).with_name("mutant.rs"), MODULE.lstrip().encode())

    def _roots(self):
        crates = (self.top / "crates").glob("*/src")
        return {(src / root).relative_to(self.top).as_posix() for src in crates for root in ("lib.rs", "main.rs") if (src / root).is_file()}

    def _render(self):
        """Writes the files with choices, and returns them by their paths."""
        rendered = {}
        by_path = {}
        for change in self.changes:
            by_path.setdefault(change.path, []).append(change)
        for change in self.left_out:
            by_path.setdefault(change.path, [])
        roots = self._roots()
        for path in sorted(set(by_path) | roots):
            text = (self.top / path).read_text(encoding="utf-8")
            if path in roots:
                text += "\nmod mutant;\n"
            rendered[path] = Rendered(text, by_path.get(path, []))
            write_if_new(self.tree / path, rendered[path].written().encode())
        return rendered

    def _compile(self):
        """None, or the errors."""
        command = ["cargo", "build", "--release", "--bin", "dwell", "--workspace", "--message-format=json", "--keep-going"]
        environment = {**os.environ, "CARGO_TARGET_DIR": str(self.target), "CARGO_INCREMENTAL": "1"}
        done = subprocess.run(command, cwd=self.tree, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        errors = [m["message"] for m in messages if m["reason"] == "compiler-message" and m["message"]["level"] == "error"]
        if done.returncode == 0:
            return None
        if not errors:
            raise SystemExit(done.stderr[-4000:])
        return errors

    def _blamed(self, error, rendered):
        """The changes at the places of an error: its main place first, then the others."""
        spans = sorted(error["spans"], key=lambda span: not span["is_primary"])
        for child in error["children"]:
            spans += child["spans"]
        for span in spans:
            while span:
                file = rendered.get(span["file_name"])
                found = file.blamed(span["byte_start"], span["byte_end"]) if file else []
                if found:
                    return found
                span = (span.get("expansion") or {}).get("span")
        return []


def write_if_new(path, content):
    if not path.is_file() or path.read_bytes() != content:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
