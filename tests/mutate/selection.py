"""Selects the lines to change: all lines of the laws, and random lines of the crates between the scene and the written files."""
import hashlib
import pathlib
import re

from changes import changes_of

# Every change of every line: the laws are small, and generic over no scalar that could record their operations.
EXHAUSTIVE = ["laws"]
DRAWN = ["dynamics", "study", "scene", "report", "cli"]
# Pictures, captions and error texts write no numbers.
WITHOUT_NUMBERS = re.compile(
    r"/tests(/|\.rs)|figure|drawing|caption|explain|picture|wording|branch_note|symbols|labels|error|schema|keys|spans|diagnostics|former|animation"
)
# The files of the crate report that write numbers; its other files draw.
WRITERS = re.compile(r"report/src/(npz|json|number|summary|markdown|table|long_export|output_folder|header|files|page)\.rs")


def files(top, crates):
    """The sources of these crates that compute or write numbers, by their paths from the top."""
    found = []
    for crate in crates:
        for path in sorted((top / "crates" / crate / "src").rglob("*.rs")):
            name = path.relative_to(top).as_posix()
            if not WITHOUT_NUMBERS.search(name) and (crate != "report" or WRITERS.search(name)):
                found.append(name)
    return found


def every_change(top, crates):
    return [change for name in files(top, crates) for change in changes_of(name, (top / name).read_text(encoding="utf-8"))]


def exhaustive_changes(top):
    """Every change of the laws; of a constant the smaller one, which is the harder to see."""
    return [change for change in every_change(top, EXHAUSTIVE) if not change.what.endswith("× 2.0")]


def drawn_changes(top, lines, seed):
    """One change of each of `lines` random lines; all computing lines are equally probable."""
    by_line, seen = {}, {}
    for change in every_change(top, DRAWN):
        by_line.setdefault((change.path, change.line), []).append(change)
    def lot(place):
        """A hash of the text of the line and its index among equal lines of the file. It does not change if other lines do."""
        (path, line), text = place, line_of(top, by_line[place][0])
        seen[path, text] = seen.get((path, text), 0) + 1
        return hashlib.sha256(f"{seed} {path} {text} {seen[path, text]}".encode()).digest()
    lots = {place: lot(place) for place in sorted(by_line)}
    places = sorted(lots, key=lots.get)[:lines]
    return [by_line[place][int.from_bytes(lots[place][:8], "big") % len(by_line[place])] for place in sorted(places)]


def top():
    return pathlib.Path(__file__).resolve().parents[2]


def line_of(top, change):
    """The text of the line that is changed."""
    return (top / change.path).read_text(encoding="utf-8").splitlines()[change.line - 1].strip()
