#!/usr/bin/env python3
"""Counts the lines of code in crates/*/src: no tests, no documentation, no comments, no blank lines; in a second column those of Python,
JavaScript, style and templates in other languages (their comments count), which includes the programs in tests/ and validation/.

    python3 tests/house/lines.py             # this checkout, crate by crate
    python3 tests/house/lines.py FOLDER      # another checkout
"""
import pathlib
import re
import sys

TOP = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
if TOP.is_file():
    TOP = TOP.parents[2]
TOKEN = re.compile(r'(//[^\n]*|/\*.*?\*/)|b?r(\#*)".*?"\2|b?"(?:\\.|[^"\\])*"|b?\'(?:\\.[^\']*|[^\'\\])\'', re.S)
TESTS = re.compile(r"#\[cfg\(test\)\]\s*(?:#\[[^\]]*\]\s*)*(?:pub(?:\([^)]*\))?\s+)?mod\s+(\w+)\s*([{;])")


def lines_of(path, left_out):
    text = path.read_text(encoding="utf-8")
    text = TOKEN.sub(lambda m: re.sub(r"[^\n]", "", m.group(0)) if m.group(1) else re.sub(r"[{}]", "x", m.group(0)), text)
    while found := TESTS.search(text):
        end = found.end()
        if found.group(2) == "{":
            depth = 1
            while depth and end < len(text):
                depth += {"{": 1, "}": -1}.get(text[end], 0)
                end += 1
        else:
            folder = path.parent if path.name in ("lib.rs", "main.rs", "mod.rs") else path.with_suffix("")
            left_out += [folder / f"{found.group(1)}.rs", folder / found.group(1)]
        text = text[: found.start()] + text[end:]
    return sum(1 for line in text.split("\n") if line.strip())


OTHERS = {".py", ".js", ".mjs", ".c", ".h", ".m", ".css", ".html"}
# Generated or downloaded files.
MADE = {"node_modules", "target", "__pycache__"}


def others_of(folder):
    paths = (p for p in folder.rglob("*") if p.suffix in OTHERS and not MADE & set(p.parts[len(folder.parts):]))
    return sum(1 for path in paths for line in path.read_text(encoding="utf-8").splitlines() if line.strip())


total, others = 0, 0
for crate in sorted(TOP.glob("crates/*/src")):
    left_out, counts = [], {}
    for path in sorted(crate.rglob("*.rs")):
        counts[path] = lines_of(path, left_out)
    counts = {p: n for p, n in counts.items() if not any(p == out or out in p.parents for out in left_out)}
    other = others_of(crate.parent)
    print(f"{sum(counts.values()):6} {other:6} {crate.parent.name}")
    total, others = total + sum(counts.values()), others + other
for name in ("docs", "tests", "validation"):
    other = others_of(TOP / name)
    print(f"{0:6} {other:6} {name}")
    others += other
print(f"{total:6} {others:6} in all")
