"""Which numbers of what a run wrote differ from those of another run, and by how much."""
import io
import json
import math
import re
import struct
import zipfile

# A database holds the times of its rows; its numbers are also in the CSV file beside it.
PICTURES = {".png", ".svg", ".gif", ".sqlite"}
# A number has changed where it differs by more than this, relative to the largest of its column or to itself.
EFFECTIVE = 1e-9
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\bNaN\b|\binf\b")
# What is measured of the machine, or says where files are, is no result.
IGNORED = re.compile(r"second|running for|time:|\btime\b.*ms|program|sha256|hash|seconds|version", re.I)
# Numbers that say how certain or how costly a result is, not what it is.
ESTIMATES = re.compile(r"error|estimate|step|evaluation|reject|jacobian|condition|uncertain|accura|drift|toleran|rtol|atol|digits", re.I)


def numbers(name, data):
    """The numbers of a file by the name of what they are: {label: [numbers]}."""
    ending = name.rsplit(".", 1)[-1]
    try:
        if ending == "npz":
            return of_npz(data)
        text = data.decode("utf-8", errors="replace")
        if ending == "json":
            return of_json(json.loads(text))
        if ending == "csv":
            return of_csv(text)
        if ending == "table":
            return of_table(text)
        return of_text(text)
    except (ValueError, KeyError, zipfile.BadZipFile, struct.error):
        return {"unreadable": [float(len(data))]}


def of_npz(data):
    """Arrays of doubles, and everything else by its bytes."""
    found = {}
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for name in archive.namelist():
            content = archive.read(name)
            begin = 10 + struct.unpack("<H", content[8:10])[0]
            if b"'<f8'" in content[:begin]:
                found[name] = list(struct.unpack(f"<{(len(content) - begin) // 8}d", content[begin:]))
            else:
                found[name] = [float(sum(content))]
    return found


def of_json(value, label="", found=None):
    found = {} if found is None else found
    if isinstance(value, dict):
        # Where an entry says its name, it is known by it.
        for key, inner in value.items():
            if key not in ("files", "printed", "program", "messages"):
                of_json(inner, f"{label}.{key}", found)
    elif isinstance(value, list):
        for inner in value:
            of_json(inner, label, found)
    elif isinstance(value, (int, float)):
        found.setdefault(label, []).append(float(value))
    elif isinstance(value, str):
        found.setdefault(label + " (text)", []).append(float(sum(value.encode())))
    return found


def of_csv(text):
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    columns = lines[0].split(",") if lines else []
    found = {name: [] for name in columns}
    for line in lines[1:]:
        for name, entry in zip(columns, line.split(",")):
            try:
                found[name].append(float(entry))
            except ValueError:
                found.setdefault(name + " (text)", []).append(float(sum(entry.encode())))
    return found


def of_table(text):
    """The numbers of a table file by the first word of their lines; its checksum follows from them."""
    found = {}
    for line in text.splitlines():
        word, *rest = line.split(" ")
        if word not in ("check", "scene"):
            found.setdefault(word, []).extend(float(number) for number in NUMBER.findall(" ".join(rest)))
    return found


def of_text(text):
    """The numbers of sentences, by the words around them."""
    found = {}
    for line in text.splitlines():
        label = re.sub(r"\s+", " ", NUMBER.sub("#", line)).strip()
        for number in NUMBER.findall(line):
            found.setdefault(label, []).append(float(number))
    return found


class Difference:
    """What differs between two runs."""

    def __init__(self):
        self.largest, self.place, self.only_estimates, self.count = 0.0, "", True, 0
        # Of results, not estimates: where they are written, by the endings of files, or "printed".
        self.kinds = set()

    def add(self, place, label, size):
        is_estimate = bool(ESTIMATES.search(label))
        self.count += 1
        if not is_estimate:
            self.kinds.add(place.rsplit(".", 1)[-1])
        # A result outweighs an estimate.
        if (not is_estimate, size) > (not self.only_estimates, self.largest):
            self.largest, self.place = size, f"{place}: {label}"
        self.only_estimates &= is_estimate


def difference(base, other, varying=frozenset()):
    """The difference of two runs' written numbers; None where there is none."""
    found = Difference()
    sentences = lambda written: "\n".join(line for line in written.printed.splitlines() if not IGNORED.search(line)).encode()
    pairs = [("printed", sentences(base), sentences(other))]
    for name in sorted(set(base.files) | set(other.files)):
        if name not in base.files or name not in other.files:
            found.add(name, "the file", math.inf)
        else:
            pairs.append((name, base.files[name], other.files[name]))
    for name, a, b in pairs:
        if a != b:
            compare(found, name, numbers(name, a), numbers(name, b), varying)
    return found if found.count else None


def varying(a, b):
    """The labels whose numbers differ at all."""
    found = set()
    pairs = [("printed", a.printed.encode(), b.printed.encode())] + [(name, a.files[name], b.files.get(name, b"")) for name in a.files]
    for name, one, other in pairs:
        if one != other:
            one, other = numbers(name, one), numbers(name, other)
            found |= {(name, label) for label in one.keys() | other.keys() if one.get(label) != other.get(label)}
    return frozenset(found)


def compare(found, name, a, b, varying):
    for label in a.keys() | b.keys():
        if IGNORED.search(label) or (name, label) in varying:
            continue
        if len(a.get(label, ())) != len(b.get(label, ())):
            found.add(name, label, math.inf)
            continue
        scale = max((abs(x) for x in a.get(label, ()) if math.isfinite(x)), default=0.0)
        for x, y in zip(a.get(label, ()), b.get(label, ())):
            if x == y or math.isnan(x) and math.isnan(y):
                continue
            size = abs(x - y) / scale if scale else math.inf
            if not size <= EFFECTIVE:
                found.add(name, label, size if size == size else math.inf)
