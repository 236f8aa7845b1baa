"""Compares the written numbers of two runs: which of them differ, and by how much."""
import io
import json
import math
import re
import struct
import zipfile

# The rows of a sweep's Parquet files are also in the table that is asked for.
PICTURES = {".png", ".svg", ".gif", ".parquet"}
# A number has changed where it differs by more than this, relative to the largest of its column or to itself.
EFFECTIVE = 1e-9
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\bNaN\b|\binf\b")
# Times, memory and paths of files are no results.
IGNORED = re.compile(r"second|running for|time:|\btime\b.*ms|program|sha256|hash|seconds|version", re.I)
# Estimated errors and costs of results.
ESTIMATES = re.compile(
    r"error|estimate|step|evaluation|reject|jacobian|factoris|condition|uncertain|accura|drift|toleran|rtol|atol|digits"
    r"|residual|closes to|work_sum|\bhint\b|\bruns\b|worst_at", re.I
)
# A row of a table of extrema, and how the place of an extremum is named in sentences, tables and summaries, with its value.
EXTREMA = re.compile(r"\| [^|]* \|(?: [^|]* \|)? # \| # \| # \| # \|")
PLACE = re.compile(r" at$| at \S+ \[[^]]*\]$|\.at$")
VALUES = {".at": ".value", " at": ""}
# From this part of the span on it is another place, not the same one less exactly.
OTHER_PLACE = 0.01
# Near an extremum the value changes by the square: up to this part of the span the place is the same to the value's rounding.
SAME_PLACE = 3e-5
# A column that is zero but for rounding has changed where it differs by this part of the largest of its unit, times EFFECTIVE.
OF_UNIT = 1e-6
UNIT = re.compile(r"\[[^]]*\]$")
# A motion has changed where it differs by more than so many times what half the tolerance changes of it.
TIMES_TOLERANCE = 4.0
# A result within the error that is stated beside it is no wrong number. What the changed program states counts up to so many times what is
# stated without the change, for it may be wrong itself.
TIMES_STATED = 10.0
# Around the name of a quantity in the labels of tables, files and summaries.
AROUND = re.compile(r"^\| |^\.extrema\.|^\.results\.| \[[^]]*\]$|\.npy$|\.(?:min|max)(?: at \S+ \[[^]]*\]$|\.value$|$)|\.value$| \|.*$")


# A printed number with other digits is the same where it agrees to the fewer of both, if these are not fewer than about three.
FEWEST_DIGITS = 2e-3


class Printed(float):
    """A number of a sentence, with the value of one in its last digit."""

    def __new__(cls, text):
        made = super().__new__(cls, text)
        mantissa, _, exponent = text.lower().partition("e")
        decimals = len(mantissa.partition(".")[2])
        is_plain = mantissa.strip("+-").replace(".", "").isdigit()
        made.digit = float(f"1e{int(exponent or 0) - decimals}") if is_plain else 0.0
        return made


def same_printed(x, y):
    if not (isinstance(x, Printed) and isinstance(y, Printed)) or x.digit == y.digit:
        return False
    coarse = max(x.digit, y.digit)
    return abs(x - y) <= 0.51 * coarse and coarse <= FEWEST_DIGITS * max(abs(x), abs(y))


def numbers(name, data):
    """The numbers of a file by the names of their quantities: {label: [numbers]}."""
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
    """The arrays of doubles as numbers, and all other entries as bytes."""
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
        # An entry with a name is labelled by it.
        for key, inner in value.items():
            if key not in ("files", "printed", "program", "messages"):
                of_json(inner, f"{label}.{key}", found)
    elif isinstance(value, list):
        for inner in value:
            # Extrema by the quantity that they are of.
            named = isinstance(inner, dict) and inner.get("quantity")
            of_json(inner, f"{label}.{named}" if named else label, found)
    elif isinstance(value, (int, float)):
        found.setdefault(label, []).append(float(value))
    elif isinstance(value, str):
        found.setdefault(label + " (text)", []).append(float(sum(value.encode())))
    return found


def of_csv(text):
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    columns = lines[0].split(",") if lines else []
    found = {name: [] for name in columns}
    by_quantity = columns[:1] == ["quantity"]
    for line in lines[1:]:
        entries = line.split(",")
        for name, entry in zip(columns, entries):
            name = f"{entries[0]}.{name}" if by_quantity else name
            try:
                found.setdefault(name, []).append(float(entry))
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
    """The numbers in sentences, labelled by the words around them."""
    found = {}
    for line in text.splitlines():
        label = re.sub(r"\s+", " ", NUMBER.sub("#", line)).strip()
        found_here = [Printed(number) for number in NUMBER.findall(line)]
        if EXTREMA.fullmatch(label):
            # The smallest and where, the largest and where.
            numbers_here = found_here[-4:]
            for end, value, at in zip(("min", "max"), numbers_here[0::2], numbers_here[1::2]):
                found.setdefault(f"{label} {end}", []).append(value)
                found.setdefault(f"{label} {end} at", []).append(at)
        elif found_here:
            found.setdefault(label, []).extend(found_here)
    return found


def is_other_place(label, differs, sizes_here, threshold):
    """Whether this is the place of an extremum of the same value: as near as the value's rounding or error shows, or reached elsewhere, too,
    a period later, for instance. `threshold(label)` is the size from which on a value has changed."""
    if not PLACE.search(label):
        return False
    value = next((label[: -len(end)] + new for end, new in VALUES.items() if label.endswith(end)), PLACE.sub("", label))
    if value not in sizes_here or sizes_here[value] > threshold(value):
        return False
    same_place = max(SAME_PLACE, math.sqrt(threshold(value)))
    return differs <= same_place or differs >= OTHER_PLACE


def quantity_of(label):
    """The quantity of a label, independent of its file."""
    before = None
    while before != label:
        before, label = label, AROUND.sub("", label)
    return label


def stated(written):
    """The estimated errors that a run states, by quantity."""
    errors = {}
    for name, data in written.files.items():
        if not name.endswith(".json"):
            continue
        summary = json.loads(data)
        for entry in summary.get("extrema", ()):
            errors[entry["quantity"]] = entry.get("estimated_error") or 0.0
        for key, entry in summary.get("results", {}).items():
            errors[key] = entry.get("estimated_error") or 0.0
    return errors


def slack(base, other):
    """The allowed difference of each quantity: the sum of both stated errors."""
    of_base, of_other = stated(base), stated(other)
    return {name: error + min(of_other.get(name, 0.0), TIMES_STATED * error) for name, error in of_base.items() if math.isfinite(error)}


class Difference:
    """The difference of two runs."""

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


def difference(base, other, effective=None):
    """The difference of two runs' written numbers; None where there is none. `effective` holds the sizes from which on a label has
    changed, where that is not EFFECTIVE."""
    effective = effective or {}
    found = Difference()
    sentences = lambda written: "\n".join(line for line in written.printed.splitlines() if not IGNORED.search(line)).encode()
    pairs = [("printed", sentences(base), sentences(other))]
    for name in sorted(set(base.files) | set(other.files)):
        if name not in base.files or name not in other.files:
            found.add(name, "the file", math.inf)
        else:
            pairs.append((name, base.files[name], other.files[name]))
    errors = slack(base, other)
    for name, a, b in pairs:
        if a != b:
            compare(found, name, numbers(name, a), numbers(name, b), effective, errors)
    return found if found.count else None


def sizes(a, b):
    """How much each label differs between two runs, for all that differ at all."""
    found = {}
    pairs = [("printed", a.printed.encode(), b.printed.encode())]
    pairs += [(name, a.files.get(name, b""), b.files.get(name, b"")) for name in a.files.keys() | b.files.keys()]
    for name, one, other in pairs:
        if one != other:
            one, other = numbers(name, one), numbers(name, other)
            of = all_sizes(one, other)
            found |= {(name, label): differs for label, differs in of.items() if differs}
    return found


def all_sizes(a, b, errors=None):
    """By label: the difference of its numbers beyond the error of its quantity. An extremum that is zero is compared by the other end, a
    column that is zero but for rounding by the others of its unit."""
    errors = errors or {}
    largest_of = {label: max((abs(x) for x in values if math.isfinite(x)), default=0.0) for label, values in a.items()}
    of_unit = {}
    for label, largest in largest_of.items():
        if unit := UNIT.search(label):
            of_unit[unit[0]] = max(of_unit.get(unit[0], 0.0), largest)
    def floor(label):
        unit = UNIT.search(label)
        return max(largest_of.get(other_end(label), 0.0), OF_UNIT * of_unit.get(unit[0], 0.0) if unit else 0.0)
    def error(label):
        return 0.0 if PLACE.search(label) or ESTIMATES.search(label) else errors.get(quantity_of(label), 0.0)
    return {label: size(a.get(label, ()), b.get(label, ()), floor(label), error(label)) for label in a.keys() | b.keys()}


def other_end(label):
    """The label of the largest where this is that of the smallest, and the reverse; none of a place."""
    if PLACE.search(label):
        return ""
    swapped = re.sub(r"\b(min|max)\b", lambda found: {"min": "max", "max": "min"}[found[0]], label)
    return swapped if swapped != label else ""


def size(a, b, floor=0.0, error=0.0):
    """The largest difference of two lists of numbers beyond an error, relative to the largest of the first, or a floor; infinite where they
    cannot be compared."""
    if len(a) != len(b):
        return math.inf
    scale = max((abs(x) for x in a if math.isfinite(x)), default=0.0)
    scale = max(scale, floor)
    largest = 0.0
    for x, y in zip(a, b):
        if x == y or math.isnan(x) and math.isnan(y) or same_printed(x, y):
            continue
        beyond = max(abs(x - y) - error, 0.0)
        differs = 0.0 if not beyond else beyond / scale if scale else math.inf
        largest = max(largest, differs if differs == differs else math.inf)
    return largest


def compare(found, name, a, b, effective, errors):
    sizes_here = all_sizes(a, b, errors)
    threshold = lambda label: effective.get((name, label), EFFECTIVE)
    for label, differs in sizes_here.items():
        if not IGNORED.search(label):
            if differs > threshold(label) and not is_other_place(label, differs, sizes_here, threshold):
                found.add(name, label, differs)
