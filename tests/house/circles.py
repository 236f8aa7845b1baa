#!/usr/bin/env python3
"""Counts circular imports between the folders of each crate; exits with status 1 if there are any.

A file may import from a file of its own folder that imports it back: such files tell one story. A module and the files below it
(`plan.rs` and `plan/*.rs`) are one folder. The root of a crate is no folder in this sense: its files are ideas of their own.
Imports are the names in `use` and in paths, followed through re-exports. Code of tests does not count.

    python3 tests/house/circles.py            # the whole workspace
    python3 tests/house/circles.py --imports  # every import, file by file
"""
import pathlib
import re
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|b?r(\#*)".*?"\1|b?"(?:\\.|[^"\\])*"|b?\'(?:\\.[^\']*|[^\'\\])\'', re.S)


def code_of(path):
    """The text without comments, strings and modules of tests."""
    text = TOKEN.sub(" ", path.read_text(encoding="utf-8"))
    while found := re.search(r"#\[cfg\(test\)\]\s*(?:#\[[^\]]*\]\s*)*(?:pub(?:\([^)]*\))?\s+)?mod\s+\w+\s*(\{|;)", text):
        end = found.end()
        if found.group(1) == "{":
            depth = 1
            while depth and end < len(text):
                depth += {"{": 1, "}": -1}.get(text[end], 0)
                end += 1
        text = text[: found.start()] + text[end:]
    return text


class Crate:
    """The modules of one crate, by their paths from its root."""

    def __init__(self, source):
        self.source = source
        self.files, self.code = {}, {}
        self.walk((), source / "lib.rs" if (source / "lib.rs").exists() else source / "main.rs")
        self.reexports = {module: dict(self.uses(module, public=True)) for module in self.files}

    def walk(self, module, path):
        self.files[module], self.code[module] = path, code_of(path)
        folder = path.parent if path.name in ("lib.rs", "main.rs", "mod.rs") else path.with_suffix("")
        for name in re.findall(r"\bmod\s+(\w+)\s*;", self.code[module]):
            for candidate in (folder / f"{name}.rs", folder / name / "mod.rs"):
                if candidate.exists():
                    self.walk((*module, name), candidate)

    def folder(self, module):
        """The folder of a module. A module with modules below it is its own folder."""
        return module if any(m[:-1] == module for m in self.files if m) else module[:-1]

    def uses(self, module, public=False):
        """Pairs (name it gets, path from the crate's root) of the module's `use` lines."""
        start = r"\bpub(?:\([^)]*\))?\s+use\s+" if public else r"\buse\s+"
        for tree in re.findall(start + r"([^;]+);", self.code[module]):
            for path in expand(re.sub(r"\s+", " ", tree.strip())):
                name = path[-1]
                if " as " in name:
                    original, name = name.split(" as ")
                    path = [*path[:-1], original.strip()]
                    name = name.strip()
                absolute = self.absolute(module, path)
                if absolute is not None:
                    yield name, absolute

    def absolute(self, module, path):
        if path[0] == "crate":
            return tuple(path[1:])
        if path[0] == "self":
            return (*module, *path[1:])
        if path[0] == "super":
            up = 0
            while up < len(path) and path[up] == "super":
                up += 1
            return (*module[: len(module) - up], *path[up:])
        return (*module, *path) if (*module, path[0]) in self.files else None

    def home(self, path, seen=()):
        """The module that defines what a path from the crate's root names."""
        module = ()
        for at, name in enumerate(path):
            if (*module, name) in self.files:
                module = (*module, name)
                continue
            target = self.reexports.get(module, {}).get(name)
            if target is not None and target not in seen:
                return self.home((*target, *path[at + 1 :]), (*seen, target))
            break
        return module

    def imports(self, module):
        found = {self.home(path) for _, path in self.uses(module)}
        for path in re.findall(r"\b((?:crate|super)(?:::\w+)+)", self.code[module]):
            absolute = self.absolute(module, path.split("::"))
            found.add(self.home(absolute))
        return found - {module}


def expand(tree):
    """`a::{b, c::{d, e as f}}` → [a, b], [a, c, d], [a, c, "e as f"]."""
    if "{" not in tree:
        yield [part.strip() for part in tree.split("::")]
        return
    head, rest = tree.split("{", 1)
    rest = rest[: rest.rindex("}")]
    head = [part.strip() for part in head.split("::") if part.strip()]
    depth, item = 0, ""
    for letter in [*rest, ","]:
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            if item.strip():
                for path in expand(item.strip()):
                    yield head + (path[1:] if path[0] == "self" and len(path) > 1 else [] if path == ["self"] else path)
            item = ""
        else:
            item += letter


def circles(edges):
    """Strongly connected components of more than one module (Tarjan, without recursion)."""
    index, low, stack, on, found = {}, {}, [], set(), []
    for root in edges:
        if root in index:
            continue
        work = [(root, iter(sorted(edges[root])))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on.add(root)
        while work:
            node, rest = work[-1]
            for other in rest:
                if other not in index:
                    index[other] = low[other] = len(index)
                    stack.append(other)
                    on.add(other)
                    work.append((other, iter(sorted(edges[other]))))
                    break
                if other in on:
                    low[node] = min(low[node], index[other])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    component = []
                    while True:
                        other = stack.pop()
                        on.discard(other)
                        component.append(other)
                        if other == node:
                            break
                    if len(component) > 1:
                        found.append(sorted(component))
    return found


def main():
    count = 0
    for source in sorted(TOP.glob("crates/*/src")):
        crate = Crate(source)
        edges = {module: {m for m in crate.imports(module) if m != ()} for module in crate.files if module != ()}
        if "--imports" in sys.argv:
            for module, others in sorted(edges.items()):
                print(f"{source.parent.name}: {'::'.join(module)} -> {', '.join(sorted('::'.join(m) for m in others))}")
        for circle in circles(edges):
            folders = {crate.folder(module) for module in circle}
            if len(folders) == 1 and folders != {()}:
                continue
            count += 1
            print(f"{source.parent.name}: {' <-> '.join('::'.join(m) for m in circle)}")
    print(f"{count} circles of imports between folders")
    sys.exit(1 if count else 0)


main()
