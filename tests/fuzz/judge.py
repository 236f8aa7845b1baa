"""Rules for every run, independent of the scene and the command: the exit status, the messages, the printed numbers and the files
are consistent."""
import csv
import math
import re
import tomllib

# Longest computing time on one thread without output, s, and largest memory, bytes.
LONGEST = 10
# The status of a run that exceeds its computing time (SIGXCPU).
OUT_OF_TIME = -24
LARGEST = 2 * 2**30
NUMBER = r"[-−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
# Non-finite numbers as Rust prints them.
NON_FINITE = re.compile(r"(?<![\w.`-])[-−]?(?:NaN|inf)(?![\w`-])")
# The progress line, which a long run prints after 2 s and then in growing intervals.
GOES_ON = re.compile(r"^dwell [a-z-]+: running for \d+ (?:s|min)", re.M)
# The first characters of messages of miette and clap.
ERROR = re.compile(r"^\s*(?:×|Error:|error:)", re.M)


class Run:
    """The outcome of a run of the command."""

    def __init__(self, arguments, scene, status, out, err, seconds, memory, folder):
        self.arguments, self.scene, self.status, self.out, self.err = arguments, scene, status, out, err
        self.seconds, self.memory, self.folder = seconds, memory, folder

    def files(self, ending):
        return sorted(self.folder.glob(f"**/*{ending}"))

    def table(self, ending):
        """The rows of the CSV file with this ending as dictionaries by column names without units; None if there is no such file."""
        found = self.files(ending)
        if not found:
            return None
        with open(found[0], encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        head = [name.split(" [")[0] for name in rows[0]]
        return [dict(zip(head, row)) for row in rows[1:]]


def faults(run):
    """The faults of a run, each as a sentence. After a crash nothing else is judged, because its output is no result."""
    crash = crashed(run)
    if crash or out_of_time(run):
        return [crash] if crash else []
    return [fault for check in CHECKS if (fault := check(run))]


def out_of_time(run):
    return run.status == OUT_OF_TIME


def crashed(run):
    if "panicked at" in run.err:
        place = run.err[run.err.index("panicked at"):].splitlines()
        return "panic: " + " ".join(place[:2])
    if "memory allocation of" in run.err or "overflowed its stack" in run.err:
        return "no memory: " + run.err.strip().splitlines()[-1]
    if run.memory > LARGEST:
        return f"{run.memory / 2**20:.0f} MB of memory"
    if out_of_time(run):
        return None if GOES_ON.search(run.err) else f"silent for {LONGEST} s of computing"
    return None if run.status in (0, 1, 2) else f"status {run.status}"


def status_and_sentence(run):
    said = bool(ERROR.search(run.err))
    if run.status == 0 and said:
        return "status 0 with an error: " + sentence(run.err)
    if run.status == 2 and not said:
        return "status 2 without an error"
    if run.status == 2 and run.folder.joinpath("reports").exists():
        return "status 2 with files"
    if run.status == 1 and not said and "FAIL" not in run.out and not re.search(r"\bfail", run.out):
        return "status 1 without a reason"
    return None


def sentence(text):
    return " ".join(" ".join(line.strip(" │×╰─▶├") for line in text.splitlines()[:4]).split())


def non_finite_print(run):
    found = NON_FINITE.search(run.out) if run.status == 0 else None
    if found:
        line = run.out[run.out.rfind("\n", 0, found.start()) + 1:].splitlines()[0]
        return "status 0 with a number that is none: " + line.strip()
    return None


# Columns that are undefined in some rows: ratios at a dead point, poles at rest, modes of equilibria that have fewer of them,
# a stability that the linearisation does not decide, the tolerance of a quadrature.
UNDEFINED = ("tolerance", "mechanical_advantage", "pole", "ratio", "transmission", "relative_error", "mode", "table_", "stability")


def non_finite_file(run):
    if run.status != 0 or run.arguments[0] == "sweep":
        return None
    for path in run.files(".csv"):
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        for row in rows[1:]:
            for name, cell in zip(rows[0], row):
                if cell in ("inf", "-inf", "NaN") or cell == "" and not any(part in name for part in UNDEFINED) and numeric(rows, name):
                    return f"status 0 with `{cell}` in column {name} of {path.name}"
    return None


def numeric(rows, name):
    """Whether a column holds numbers."""
    k = rows[0].index(name)
    return any(re.fullmatch(NUMBER, row[k]) for row in rows[1:] if len(row) > k)


def digits_agree(printed, value, error=0.0):
    """Whether a printed number is the value rounded to the printed digits, or to the digits within its stated error."""
    # The last printed digit is the first one beyond the error, or one more.
    if abs(float(printed.replace("−", "-")) - value) <= 10 * error:
        return True
    mantissa = re.sub(r"e.*", "", printed.replace("−", "-"))
    printed = float(printed.replace("−", "-"))
    decimals = len(mantissa.partition(".")[2])
    exponent = math.floor(math.log10(abs(printed))) if printed else 0
    whole = len(mantissa.lstrip("-0.").replace(".", ""))
    last = 10.0 ** (exponent - max(whole - 1, 5)) if printed else 1e-300
    return abs(printed - value) <= 0.51 * max(last, 0.0) + 1e-12 * abs(value) or decimals == 0 and abs(printed - value) <= 0.5 * last


TRAJECTORIES = {"simulate": "-motion", "kinematics": "-kinematics", "statics": "-statics", "kinetostatics": "-kinetostatics"}


def rows_as_printed(run):
    """The printed number of positions and the printed end of the motion agree with the table."""
    kind = TRAJECTORIES.get(run.arguments[0])
    head = re.search(r", (?:(\d+) of )?(\d+) positions? over (.*)", run.out)
    if not kind or not head or run.status == 2:
        return None
    rows = run.table(f"{kind}.csv")
    if rows is None:
        return "a summary without a table"
    reached = int(head[1] or head[2])
    if len(rows) != reached:
        return f"{reached} positions printed, {len(rows)} rows"
    if run.status == 0 and head[1]:
        return f"status 0 with {head[1]} of {head[2]} positions"
    motion = re.search(rf"a free motion of ({NUMBER})", head[3])
    end = re.search(rf"^  ({NUMBER}) (?:of ({NUMBER}) )?s (?:\(estimated error {NUMBER} s\) )?by ", run.out, re.M)
    times = [float(row["t"]) for row in rows] if rows and "t" in rows[0] else []
    if any(b <= a for a, b in zip(times, times[1:])):
        return "the times of the rows do not ascend"
    if run.arguments[0] != "simulate" or not times:
        return None
    # Rows within the fit across a change point are left out, also the last.
    is_fitted = "where the tables have no rows" in run.out
    # Where the rows end before the motion, as the first line says, the status is 1 and the reason is said.
    ends_early = bool(head[1])
    if motion and not is_fitted and not ends_early and not digits_agree(motion[1], times[-1]):
        return f"a motion of {motion[1]} s printed, and {times[-1]} s in the last row"
    if end and not is_fitted and not ends_early and not digits_agree(end[1], times[-1]):
        return f"an end at {end[1]} s printed, and {times[-1]} s in the last row"
    if end and end[2] and run.status == 0 and "the motion ends there" not in run.out:
        return f"status 0 with {end[1]} of {end[2]} s and no event that ends it"
    return None


def duration_as_wanted(run):
    """A motion with status 0 lasts as long as the scene says, unless an event ends it."""
    if run.arguments[0] != "simulate" or run.status != 0 or "the motion ends there" in run.out:
        return None
    # Rows within the fit across a change point are left out, as the run says; also the last.
    if "where the tables have no rows" in run.out:
        return None
    try:
        wanted = tomllib.loads(run.scene)["motion"]["duration"]
    except (tomllib.TOMLDecodeError, KeyError, TypeError):
        return None
    rows = run.table("-motion.csv") or []
    times = [float(row["t"]) for row in rows if "t" in row]
    # Behind a change of the coordinate the end is rounded.
    if times and abs(times[-1] - wanted) > 1e-14 * wanted:
        return f"status 0 at {times[-1]} s of {wanted} s"
    return None


def events_as_printed(run):
    if run.arguments[0] != "simulate" or run.status == 2:
        return None
    often = {"never": 0, "once": 1, "twice": 2}
    # An event of the scene, or what a contact or the switch of a load does.
    printed = re.findall(rf"^  (\S+|.+ \(event \d+\)): (never|once|twice|\d+ times)(?:, first at t = ({NUMBER}) s(?: \(estimated error ({NUMBER}) s\))?)?(; the motion ends there)?", run.out, re.M)
    rows = run.table("-motion-events.csv") or []
    printed = [(name, often[count] if count in often else int(count.split()[0]), *rest) for name, count, *rest in printed]
    if sum(count for _, count, *_ in printed) != len(rows):
        return f"{printed} printed, and {len(rows)} events in the file"
    times = [float(row["t"]) for row in rows]
    if times != sorted(times):
        return "events out of order"
    for name, count, at, error, stops in printed:
        if at and not any(digits_agree(at, t, float(error or 0)) for t in times):
            return f"event {name} at {at} s printed, and not in the file"
        if stops and count != 1:
            return f"event {name} ends the motion, {count} times"
    motion = run.table("-motion.csv") or []
    last = [float(row["t"]) for row in motion if "t" in row][-1:]
    if last and times and times[-1] > last[0] * (1 + 1e-12):
        return f"an event at {times[-1]} s, behind the end at {last[0]} s"
    return None


def extrema_bound_rows(run):
    """No row is beyond the extrema of its column, and the printed extrema are in the file."""
    kind = TRAJECTORIES.get(run.arguments[0])
    if not kind or run.status == 2:
        return None
    rows, extrema = run.table(f"{kind}.csv"), run.table(f"{kind}-extrema.csv")
    if rows is None or extrema is None:
        return None
    of = {row["quantity"]: row for row in extrema}
    largest = max([1, *(abs(float(cell)) for row in rows for cell in row.values() if cell)])
    for name, row in of.items():
        cells = [float(r[name]) for r in rows if r.get(name)]
        if not cells:
            continue
        low, high = float(row["min"]), float(row["max"])
        # A force that is zero but for rounding has no direction.
        if low == high == 0 and ".direction" in name:
            continue
        # Beside larger numbers that are not in the file it is said.
        zero = re.search(rf"^  zero but for rounding:.*[ ;]{re.escape(name)}, at most ({NUMBER}) ", run.out, re.M)
        if low == high == 0 and zero and max(map(abs, cells)) <= 1.1 * float(zero[1]):
            continue
        # What is zero but for rounding is zero among the extrema: beside the largest number, which may be an energy, or, where
        # the mechanism is a million metres large, beside a moment that is a force times that.
        rounding = max(1e-11 * largest, 1e-6 * largest_of_unit(extrema, row["unit"])) if low == high == 0 else 0
        slack = max(1e-9 * max(abs(low), abs(high), largest_of_unit(extrema, row["unit"])), rounding)
        if not (low <= min(cells) + slack and max(cells) - slack <= high):
            return f"{name}: extrema {low} and {high}, rows from {min(cells)} to {max(cells)}"
    stated = re.search(rf"estimated error of these values: at most ({NUMBER}) of each", run.out)
    error = float(stated[1]) if stated else 0.0
    for name, printed, unit in re.findall(rf"^  (\S+) reaches ({NUMBER}) (\S+)", run.out, re.M):
        factor = IN_SCENE_UNIT.get(unit.split("/")[0], 1.0)
        ends = [float(of[name][end]) * factor for end in ("min", "max")] if name in of else []
        if ends and not any(digits_agree(printed, end, error * abs(end)) for end in ends):
            return f"{name} reaches {printed}, and in the file {of[name]['min']} and {of[name]['max']}"
    return None


# Printed numbers are in the scene's units of lengths and angles; files are in SI units.
IN_SCENE_UNIT = {"deg": 180 / math.pi, "mm": 1e3, "cm": 1e2, "um": 1e6, "km": 1e-3, "in": 1 / 0.0254, "ft": 1 / 0.3048}


def largest_of_unit(extrema, unit):
    return max(max(abs(float(row["min"])), abs(float(row["max"]))) for row in extrema if row["unit"] == unit)


def accuracy_kept(run):
    """With status 0 the estimated error is within the required accuracy."""
    if "--accuracy" not in run.arguments or run.status != 0 or run.arguments[0] != "simulate":
        return None
    wanted = run.arguments[run.arguments.index("--accuracy") + 1]
    wanted = {"draft": 1e-3, "standard": 1e-6, "precise": 1e-9, "reference": 1e-10}.get(wanted) or float(wanted)
    # Each error is in its own unit of a coordinate, or a part of the largest.
    line = re.search(r"estimated errors? over the whole motion: (.*)", run.out)
    estimates = re.findall(rf"({NUMBER}) (?:\S+ in|in the|of the)", line[1]) if line else []
    if not estimates:
        return "status 0 and no estimated error"
    # Two digits are printed.
    if max(map(float, estimates)) > 1.05 * wanted:
        return f"status 0 with estimated errors {estimates} where {wanted} was asked for"
    return None


def positions_of_table(run):
    if run.arguments[0] != "reduce" or run.status == 2:
        return None
    head = re.search(r": (\d+) positions? of", run.out)
    rows = run.table("-reduced.csv")
    if head and rows is not None and len(rows) != int(head[1]):
        return f"{head[1]} positions printed, {len(rows)} rows"
    return None


CHECKS = [
    status_and_sentence, non_finite_print, non_finite_file, rows_as_printed, duration_as_wanted, events_as_printed, extrema_bound_rows,
    accuracy_kept, positions_of_table,
]
