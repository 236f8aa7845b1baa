#!/usr/bin/env python3
"""Lists files of more than 500 lines and functions of more than 60 that do not say why.

    python3 tests/house/sizes.py             # this checkout; status 1 if there are any
    python3 tests/house/sizes.py FOLDER      # another checkout

Functions of tests are not counted. A function may be longer where a comment directly above it says why, with
"long", "longer", "one arm", "one function" or "one loop".
"""
import pathlib
import re
import sys

TOP = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
if TOP.is_file():
    TOP = TOP.parents[2]
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|b?r(\#*)".*?"\1|b?"(?:\\.|[^"\\])*"|b?\'(?:\\.[^\']*|[^\'\\])\'', re.S)
FUNCTION = re.compile(r"^[ \t]*(?:pub(?:\([^)]*\))? )?(?:const )?(?:unsafe )?fn (\w+)", re.M)
# A comment, of the documentation or not, that says why a function is long.
REASON = re.compile(r"\s*//.*\b(?:long|longer|one arm|one function|one loop)\b", re.I)

found = []
for path in sorted([*TOP.glob("crates/**/*.rs"), *TOP.glob("tests/**/*.rs")]):
    if "target" in path.parts:
        continue
    text = path.read_text(encoding="utf-8")
    name = path.relative_to(TOP)
    lines = text.count("\n")
    if lines > 500:
        found.append(f"{name}: {lines} lines")
    # Braces in texts and comments do not count.
    code = TOKEN.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)
    for function in FUNCTION.finditer(code):
        depth, at = 0, function.end()
        while at < len(code) and not (depth == 0 and code[at] in ";{"):
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(code[at], 0)
            at += 1
        if at == len(code) or code[at] == ";":
            continue
        depth, begin = 1, at
        while depth and at + 1 < len(code):
            at += 1
            depth += {"{": 1, "}": -1}.get(code[at], 0)
        length = code.count("\n", function.start(), at) + 1
        above = text[: function.start()].rstrip().splitlines()
        reason = []
        while above and re.match(r"\s*(//|#\[)", above[-1]):
            reason.append(above.pop())
        says_why = any(REASON.match(line) for line in reason)
        if length > 60 and not says_why and "tests" not in path.parts and path.name != "tests.rs":
            line = code.count("\n", 0, function.start()) + 1
            found.append(f"{name}:{line}: `{function.group(1)}` has {length} lines")
for one in found:
    print(one)
print(f"{len(found)} files or functions are too long")
sys.exit(bool(found))
