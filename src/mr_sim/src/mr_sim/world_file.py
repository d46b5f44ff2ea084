"""Syntax of Stage's world files: text in, a tree of blocks with their properties and places out.

`include` and `define` are resolved here, so the tree holds only blocks of built-in kinds. What the words mean is the
business of `world_model`.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

Value = float | str | tuple[float | str, ...]

BLOCK_KINDS = frozenset({"world", "model", "position", "ranger", "laser", "sensor", "block", "window", "camera"})
MAX_INCLUDE_DEPTH = 32

_TOKEN = re.compile(
    r"""(?P<space>[ \t\r\f\v]+) | (?P<comment>\#[^\n]*) | (?P<newline>\n)
      | (?P<string>"[^"\n]*") | (?P<bracket>[()\[\]])
      | (?P<number>[-+]?\.?[0-9][^\s()\[\]"\#]*) | (?P<word>[^\s()\[\]"\#]+(?:\[[0-9]+\])?)""",
    re.VERBOSE,
)


@dataclass(frozen=True)
class Place:
    """Where a word stands."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


class WorldFileError(ValueError):
    """A world file that cannot be used: says where, which word, and what is wrong."""

    def __init__(self, place: Place | str, message: str) -> None:
        super().__init__(f"{place}: {message}")


@dataclass(frozen=True)
class Property:
    """One `word value` pair."""

    word: str
    value: Value
    place: Place


@dataclass
class Block:
    """`kind ( properties and nested blocks )`; `word` is what the file says, possibly the name of a `define`."""

    kind: str
    word: str
    place: Place
    properties: dict[str, Property] = field(default_factory=dict)
    children: list["Block"] = field(default_factory=list)


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    place: Place


def _tokens(text: str, file: str) -> Iterator[_Token]:
    line, position = 1, 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise WorldFileError(Place(file, line), f"a string without its closing quote: {text[position:].split()[0]}")
        kind = match.lastgroup or ""
        if kind not in ("space", "comment", "newline"):
            yield _Token(kind, match.group(), Place(file, line))
        line += kind == "newline"
        position = match.end()


def _number(token: _Token) -> float:
    try:
        value = float(token.text)
    except ValueError:
        raise WorldFileError(token.place, f'bad number "{token.text}"') from None
    if value - value != 0.0:
        raise WorldFileError(token.place, f'bad number "{token.text}"')
    return value


class _Parser:
    """Recursive descent over one world file and the files it includes."""

    def __init__(self) -> None:
        self._definitions: dict[str, Block] = {}
        self._open_files: list[Path] = []

    def parse_file(self, path: Path, into: Block, place: Place | None = None) -> None:
        where: Place | str = place if place is not None else str(path)
        resolved = path.resolve()
        if resolved in self._open_files:
            cycle = " -> ".join(p.name for p in [*self._open_files[self._open_files.index(resolved) :], resolved])
            raise WorldFileError(where, f"include cycle: {cycle}")
        if len(self._open_files) >= MAX_INCLUDE_DEPTH:
            raise WorldFileError(where, f"includes are nested deeper than {MAX_INCLUDE_DEPTH} files")
        try:
            text = path.read_text(encoding="utf-8")
        except FileNotFoundError:
            raise WorldFileError(where, f'no such file: "{path}"') from None
        except (OSError, UnicodeDecodeError) as error:
            raise WorldFileError(where, f'cannot read "{path}": {getattr(error, "strerror", None) or error}') from None
        self._open_files.append(resolved)
        tokens = list(_tokens(text, str(path)))
        end = self._statements(tokens, 0, into, path)
        if end < len(tokens):
            raise WorldFileError(tokens[end].place, f'unexpected "{tokens[end].text}"')
        self._open_files.pop()

    def _statements(self, tokens: Sequence[_Token], at: int, into: Block, path: Path) -> int:
        """Parse until the closing parenthesis of `into` (not consumed) or the end of the file."""
        while at < len(tokens) and tokens[at].text != ")":
            token = tokens[at]
            if token.kind != "word":
                raise WorldFileError(token.place, f"expected a word, found {token.text}")
            following = tokens[at + 1] if at + 1 < len(tokens) else None
            if following is None:
                raise WorldFileError(token.place, f'"{token.text}" has no value')
            if token.text == "include":
                at = self._include(following, at, into, path)
            elif token.text == "define":
                at = self._define(tokens, at, path)
            elif following.text == "(":
                at = self._block(tokens, at, into, path)
            else:
                value, at = self._value(tokens, at + 1, token)
                into.properties[token.text] = Property(token.text, value, token.place)
        return at

    def _include(self, following: _Token, at: int, into: Block, path: Path) -> int:
        if following.kind != "string":
            raise WorldFileError(following.place, f"include needs a file name in quotes, found {following.text}")
        self.parse_file(path.parent / following.text.strip('"'), into, following.place)
        return at + 2

    def _define(self, tokens: Sequence[_Token], at: int, path: Path) -> int:
        place = tokens[at].place
        words = tokens[at + 1 : at + 4]
        if [token.kind for token in words] != ["word", "word", "bracket"] or words[2].text != "(":
            raise WorldFileError(place, "define needs a name, a model and a block: define NAME MODEL ( ... )")
        name = words[0].text
        if name in BLOCK_KINDS:
            raise WorldFileError(words[0].place, f'"{name}" is a built-in model and cannot be defined anew')
        holder = Block("world", "define", place)
        end = self._block(tokens, at + 2, holder, path)
        self._definitions[name] = holder.children[0]
        return end

    def _block(self, tokens: Sequence[_Token], at: int, into: Block, path: Path) -> int:
        token = tokens[at]
        base = self._definitions.get(token.text)
        if base is None and token.text not in BLOCK_KINDS:
            raise WorldFileError(token.place, f'unknown model "{token.text}"')
        block = Block(base.kind if base else token.text, token.text, token.place)
        if base:
            block.properties.update(base.properties)
            block.children.extend(base.children)
        end = self._statements(tokens, at + 2, block, path)
        if end >= len(tokens):
            raise WorldFileError(token.place, f'the block of "{token.text}" is never closed')
        into.children.append(block)
        return end + 1

    @staticmethod
    def _value(tokens: Sequence[_Token], at: int, word: _Token) -> tuple[Value, int]:
        token = tokens[at]
        if token.kind == "string":
            return token.text.strip('"'), at + 1
        if token.kind == "number":
            return _number(token), at + 1
        if token.text != "[":
            raise WorldFileError(word.place, f'"{word.text}" needs a number, a string or a tuple, found {token.text}')
        values: list[float | str] = []
        for end in range(at + 1, len(tokens)):
            item = tokens[end]
            if item.text == "]":
                return tuple(values), end + 1
            if item.kind not in ("string", "number"):
                raise WorldFileError(item.place, f'bad number "{item.text}" in the tuple of "{word.text}"')
            values.append(item.text.strip('"') if item.kind == "string" else _number(item))
        raise WorldFileError(word.place, f'the tuple of "{word.text}" is never closed')


def parse_world_file(path: str | Path) -> Block:
    """Parse a world file with everything it includes.

    Returns the block of kind "world": its properties are the world's, its children the models in file order.
    Raises WorldFileError with file, line and word.
    """
    root = Block("world", "world", Place(str(path), 1))
    _Parser().parse_file(Path(path), root)
    return root
