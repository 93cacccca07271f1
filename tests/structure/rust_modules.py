"""What modules of Rust crates define, import and name, read from their source text.

Code under a `#[cfg]` that names `test`, other than by `not(test)`, and modules called `tests` are left out. Names are
followed through imports, re-exports, renamings and globs to the module that defines them. What text cannot tell is not
seen: calls of methods, and names that macros make.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

TOKEN = re.compile(
    r"""
    (?P<nothing>\s+|//[^\n]*)
    | (?P<comment>/\*)
    | (?P<text>[bc]?r(?P<hashes>\#*)"(?P<raw>.*?)"(?P=hashes)|[bc]?"(?P<plain>(?:\\.|[^"\\])*)")
    | (?P<char>b?'(?:\\(?:x..|u\{[^}]*\}|.)|[^'\\])')
    | (?P<lifetime>'\w+)
    | (?P<name>(?:r\#)?[^\W\d]\w*)
    | (?P<number>\d\w*(?:\.\d\w*)?)
    | (?P<sign>::|\.\.[.=]?|.)
    """,
    re.VERBOSE | re.DOTALL,
)
CLOSING = {"(": ")", "[": "]", "{": "}"}
#: What the definition of a name begins with.
ITEMS = {"fn", "struct", "enum", "union", "trait", "type", "const", "static"}
#: What ends with a semicolon, whatever braces it has.
TO_SEMICOLON = {"use", "const", "static", "type", "let"}
#: What commas do not end.
WITH_COMMAS = ITEMS | TO_SEMICOLON | {"mod", "impl", "unsafe", "async", "extern", "macro_rules"}


class StructureError(Exception):
    """Source that cannot be read."""


class Token(NamedTuple):
    """A word, a sign or a text of the source."""

    kind: str
    text: str
    line: int


def tokens_of(source: str) -> list[Token]:
    """The tokens of a file, without comments."""
    tokens, place, line = [], 0, 1
    while place < len(source):
        match = TOKEN.match(source, place)
        assert match is not None, "the last alternative takes any character"
        end = match.end()
        if match["comment"]:
            end = end_of_comment(source, place)
        elif match["text"]:
            tokens.append(Token("text", match["plain"] if match["raw"] is None else match["raw"], line))
        elif not match["nothing"]:
            tokens.append(Token(match.lastgroup or "", match[0].removeprefix("r#"), line))
        line += source.count("\n", place, end)
        place = end
    return tokens


def end_of_comment(source: str, place: int) -> int:
    """Where the block comment that begins at `place` ends: they nest."""
    depth = 0
    for sign in re.compile(r"/\*|\*/").finditer(source, place):
        depth += 1 if sign[0] == "/*" else -1
        if depth == 0:
            return sign.end()
    return len(source)


class Use(NamedTuple):
    """A path that code names."""

    path: tuple[str, ...]
    line: int

    def __str__(self) -> str:
        return "::".join(self.path)


@dataclass(eq=False)
class Module:
    """A module: a file, or a part of one in braces."""

    #: From the root of its crate.
    path: tuple[str, ...]
    file: Path
    parent: Module | None
    #: The folder of the files of its children.
    folder: Path
    is_inline: bool = False
    children: dict[str, Module] = field(default_factory=dict)
    #: Names that it defines.
    items: set[str] = field(default_factory=set)
    #: Names that it imports or re-exports, and whence.
    imports: dict[str, list[Use]] = field(default_factory=lambda: defaultdict(list))
    #: Modules and enumerations that it imports all names of.
    globs: list[Use] = field(default_factory=list)
    #: Paths in its code.
    uses: list[Use] = field(default_factory=list)
    #: Texts in its code.
    texts: list[tuple[str, int]] = field(default_factory=list)

    def root(self) -> Module:
        """That of the crate."""
        return self if self.parent is None else self.parent.root()

    def of_file(self) -> Module:
        """The module that is the whole file."""
        return self.parent.of_file() if self.is_inline and self.parent else self

    def imported(self) -> list[Use]:
        """All that it imports."""
        return [use for uses in self.imports.values() for use in uses] + self.globs

    def all(self) -> Iterator[Module]:
        """It and everything below."""
        yield self
        for child in self.children.values():
            yield from child.all()


class Reader:
    """Reads the tokens of a module, and the files of those below it."""

    def __init__(self, module: Module, tokens: list[Token]) -> None:
        self.module, self.tokens, self.at = module, tokens, 0

    def text(self, ahead: int = 0) -> str:
        """The token so far ahead; a text of the source is none."""
        place = self.at + ahead
        within = 0 <= place < len(self.tokens) and self.tokens[place].kind != "text"
        return self.tokens[place].text if within else ""

    def kind(self, ahead: int = 0) -> str:
        """Its kind."""
        return self.tokens[self.at + ahead].kind if 0 <= self.at + ahead < len(self.tokens) else ""

    def read(self) -> None:
        """Reads everything up to the end of the module."""
        depth = 0
        while self.at < len(self.tokens):
            token, text = self.tokens[self.at], self.text()
            if text == "#" and (self.text(1) == "[" or (self.text(1), self.text(2)) == ("!", "[")):
                is_inner = self.text(1) == "!"
                if self.attribute():
                    if is_inner:
                        return
                    self.skip()
                continue
            if token.kind == "text":
                self.module.texts.append((token.text, token.line))
            elif text == "pub":
                self.visibility()
                continue
            elif text == "mod" and self.kind(1) == "name" and self.text(2) in (";", "{"):
                self.declaration()
                continue
            elif text == "use" and (self.kind(1) == "name" or self.text(1) in ("::", "{")):
                self.at += 1
                self.tree(())
            elif depth == 0 and text == "macro_rules" and self.text(1) == "!":
                self.module.items.add(self.text(2))
                self.at += 2
            elif depth == 0 and text in ITEMS and self.kind(1) == "name" and self.text(1) not in ITEMS:
                self.module.items.add(self.text(2) if self.text(1) == "mut" else self.text(1))
                self.at += 1
            elif self.is_path():
                self.path()
                continue
            depth += (text == "{") - (text == "}")
            self.at += 1

    def visibility(self) -> None:
        """Goes behind `pub` or `pub(…)`."""
        self.at += 1
        if self.text() == "(" and self.text(1) in ("crate", "super", "self", "in"):
            self.group()

    def attribute(self) -> bool:
        """Reads an attribute; whether what it belongs to is for tests only. Texts in it may be paths."""
        self.at += 1 + (self.text(1) == "!")
        begin = self.at
        self.group()
        end, self.at = self.at, begin + 1
        while self.at < end:
            token = self.tokens[self.at]
            if self.is_path():
                self.path()
                continue
            if token.kind == "text" and re.fullmatch(r"\w+(::\w+)+", token.text):
                self.module.uses.append(Use(tuple(token.text.split("::")), token.line))
            self.at += 1
        inside = self.tokens[begin + 1 : end - 1]
        return is_for_tests(["" if token.kind == "text" else token.text for token in inside])

    def group(self) -> None:
        """Goes behind the bracket that closes the one here."""
        closing, opening, depth = CLOSING[self.text()], self.text(), 0
        while self.at < len(self.tokens):
            depth += (self.text() == opening) - (self.text() == closing)
            self.at += 1
            if depth == 0:
                return

    def skip(self) -> None:
        """Goes behind the item, statement, field or arm here."""
        while self.text() == "#":
            self.attribute()
        if self.text() == "pub":
            self.visibility()
        has_commas = self.text() in WITH_COMMAS
        is_function = self.text() == "fn" or "fn" in (self.text(1), self.text(2))
        to_semicolon = self.text() in TO_SEMICOLON and not is_function
        while self.at < len(self.tokens):
            text = self.text()
            if text in CLOSING.values():
                return
            if text in CLOSING:
                self.group()
                if text == "{" and not to_semicolon:
                    self.at += self.text() == ","
                    return
                continue
            self.at += 1
            if text == ";" or (text == "," and not has_commas):
                return

    def declaration(self) -> None:
        """Reads the declaration of a module, and the module."""
        name = self.text(1)
        module = self.module
        self.at += 2
        begin = self.at + 1
        is_inline = self.text() == "{"
        if is_inline:
            self.group()
        else:
            self.at += 1
        if name == "tests":
            return
        path, folder = (*module.path, name), module.folder / name
        if is_inline:
            child = Module(path, module.file, module, folder, is_inline=True)
            Reader(child, self.tokens[begin : self.at - 1]).read()
        else:
            files = [folder.with_name(f"{name}.rs"), folder / "mod.rs"]
            file = next((file for file in files if file.exists()), None)
            if file is None:
                raise StructureError(f"{module.file}: there is no file of `mod {name}`")
            child = Module(path, file, module, folder)
            Reader(child, tokens_of(file.read_text("utf-8"))).read()
        module.children[name] = child

    def tree(self, prefix: tuple[str, ...]) -> None:
        """Reads a tree of imports."""
        path = prefix
        while True:
            token, text = self.tokens[self.at], self.text()
            if text == "{":
                self.at += 1
                while self.text() != "}" and self.at < len(self.tokens):
                    self.tree(path)
                    self.at += self.text() == ","
                self.at += 1
                return
            self.at += 1
            if text == "::":
                path = path or ("",)
            elif text == "*":
                self.module.globs.append(Use(path, token.line))
                return
            elif token.kind == "name":
                path = path if text == "self" and path else (*path, text)
                if self.text() != "::":
                    name = path[-1]
                    if self.text() == "as":
                        name = self.text(1)
                        self.at += 2
                    self.module.imports[name].append(Use(path, token.line))
                    return
            else:
                return

    def is_path(self) -> bool:
        """Whether a path begins here: neither a field or method, nor the rest of another path."""
        return self.kind() == "name" and self.text(-1) not in (".", "::")

    def path(self) -> None:
        """Reads a path in code."""
        line, path = self.tokens[self.at].line, [self.text()]
        self.at += 1
        while self.text() == "::" and self.kind(1) == "name":
            path.append(self.text(1))
            self.at += 2
        self.module.uses.append(Use(tuple(path), line))


def is_for_tests(attribute: list[str]) -> bool:
    """Whether an attribute is a condition that tests fulfil."""
    if attribute[:1] != ["cfg"] or "test" not in attribute:
        return False
    depth = 0
    for before, text in zip(attribute, attribute[1:], strict=False):
        if text == "(":
            depth += 1 if depth or before == "not" else 0
        elif text == ")":
            depth -= 1 if depth else 0
        elif text == "test" and not depth:
            return True
    return False


def read_crate(root: Path) -> Module:
    """The modules of a crate, from the file that it begins with."""
    module = Module((), root, None, root.parent)
    Reader(module, tokens_of(root.read_text("utf-8"))).read()
    return module


def roots(crate: Path) -> list[Path]:
    """The files that libraries and programs of a package begin with."""
    source = crate / "src"
    named = [source / "lib.rs", source / "main.rs"]
    return [file for file in (*named, *sorted(source.glob("bin/*.rs"))) if file.exists()]


# Names


class Found(NamedTuple):
    """What a name stands for."""

    module: Module
    #: Something that the module defines, not the module itself.
    is_item: bool


def look_up(module: Module, name: str, seen: frozenset[tuple[int, str]]) -> list[Found]:
    """What a name stands for in a module. A module and a function may have the same name."""
    if (id(module), name) in seen:
        return []
    seen |= {(id(module), name)}
    found = [Found(module.children[name], False)] if name in module.children else []
    if name in module.items:
        found.append(Found(module, True))
    for use in module.imports.get(name, []):
        found += resolve(module, use.path, seen)
    if not found:
        for use in module.globs:
            for place in resolve(module, use.path, seen):
                found += [] if place.is_item else look_up(place.module, name, seen)
    return found


def resolve(module: Module, path: tuple[str, ...], seen: frozenset[tuple[int, str]] = frozenset()) -> list[Found]:
    """What a path stands for that is named in a module; nothing if it leads out of the crate."""
    head, rest = path[0], path[1:]
    if head in ("crate", "self", "super"):
        start = module.root() if head == "crate" else module if head == "self" else module.parent
        while start is not None and rest[:1] == ("super",):
            start, rest = start.parent, rest[1:]
        found = [] if start is None else [Found(start, False)]
    else:
        found = look_up(module, head, seen)
    for name in rest:
        modules = [place.module for place in found if not place.is_item]
        below = [place for within in modules for place in look_up(within, name, seen)]
        if not below:
            # A variant or a function of a type, or a name that a macro has made.
            return [place for place in found if place.is_item] or [Found(within, True) for within in modules]
        found = below
    return found
