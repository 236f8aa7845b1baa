"""The named faults of `named.toml`. Each replaces a text that must occur exactly once in its file.

    python3 tests/mutate/named.py        # whether all of them still find their place; status 1 if one does not
"""
import sys
import tomllib

import selection
from changes import Change

# What stands between a scene and its files; each has a fault at least, and there are ten of an auditor.
CLASSES = [
    "readers", "units", "laws", "expressions", "drives", "batches", "samplers", "tables", "files", "printed sentences", "duals",
    "integrators", "faer's groups", "cycle", "equilibria", "linearise", "exported runs",
    "variants",
]
AUDITED = 10


def named_changes(top):
    """The faults as changes, and the reasons for those that cannot be planted."""
    listed = tomllib.loads((top / "tests/mutate/named.toml").read_text(encoding="utf-8"))["fault"]
    changes, wrong, names = [], [], set()
    for fault in listed:
        if fault["name"] in names:
            wrong.append(f"named.toml: `{fault['name']}` is listed twice")
        names.add(fault["name"])
        path = top / fault["file"]
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        found = text.count(fault["find"])
        if found != 1:
            place = "the file is gone" if not path.is_file() else f"its text is there {found} times instead of once"
            wrong.append(f"named.toml: `{fault['name']}` cannot be planted in {fault['file']}: {place}: {fault['find']!r}")
            continue
        start = text.index(fault["find"])
        # A part of what is found may be the expression that is replaced.
        part = fault.get("part", fault["find"])
        start += fault["find"].index(part)
        line = text.count("\n", 0, start) + 1
        change = Change(fault["file"], line, fault["name"], (start, start + len(part)), fault["replace"])
        change.named = fault
        changes.append(change)
    classes = [fault["class"] for fault in listed]
    wrong += [f"named.toml: no fault of the class `{name}`" for name in CLASSES if name not in classes]
    wrong += [f"named.toml: `{name}` is no class" for name in sorted(set(classes) - {*CLASSES, "issue"})]
    if classes.count("issue") != AUDITED:
        wrong.append(f"named.toml: {classes.count('issue')} faults of the issue, not {AUDITED}")
    return changes, wrong


def main():
    changes, wrong = named_changes(selection.top())
    for one in wrong:
        print(one)
    print(f"{len(changes)} named faults find their place, {len(wrong)} do not")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
