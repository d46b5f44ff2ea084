"""Syntax of Stage's world files: text in, a tree of blocks with their properties and places out.

`include` and `define` are resolved here, so the tree holds only blocks of built-in kinds. What the words mean is the
business of `world_model`. As in Stage, a definition is read anew at each use, so it may name what is defined later, and
the first definition of a name holds.
"""

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from mr_sim.world_folders import world_folders
from mr_sim.world_words import BLOCK_KINDS, nearest

Value = float | str | tuple[float | str, ...]

MAX_INCLUDE_DEPTH = 32
MAX_BLOCK_DEPTH = 64
MAX_INCLUDES = 1000
MAX_BLOCKS = 100_000  # definitions that use one another make any number of a few lines

_TOKEN = re.compile(
    r"""(?P<space>[ \t\r\f\v]+) | (?P<comment>\#[^\n]*) | (?P<newline>\n)
      | (?P<string>"[^"\n]*") | (?P<bracket>[()\[\]])
      | (?P<number>[-+]?\.?[0-9][^\s()\[\]"\#]*) | (?P<word>[^\s()\[\]"\#]+(?:\[[0-9]+\][^\s()\[\]"\#]*)*)""",
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
class Remark:
    """What a reader of the file should hear of although it is no fault."""

    place: Place
    text: str


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


@dataclass(frozen=True)
class _Definition:
    """`define NAME MODEL ( ... )`: the tokens from MODEL on, the index of that one, and the file they stand in."""

    tokens: Sequence[_Token]
    at: int
    path: Path


def find_file(name: str, world: Path, mentioned_in: Path) -> Path | None:
    """A file that a world names: beside the world file, as in Stage, or else beside the file that mentions it."""
    for folder in (world.parent, mentioned_in.parent):
        if os.path.isfile(folder / name):
            return folder / name
    return None


def _on_stage_path(name: str) -> Path | None:
    """Stage looks for the bare name of a missing file in the folders of STAGEPATH; the project's worlds come last."""
    given = [Path(folder) for folder in os.environ.get("STAGEPATH", "").split(":") if folder]
    found = (folder / Path(name).name for folder in [*given, *world_folders()])
    return next((path for path in found if os.path.isfile(path)), None)


def _decoded(octets: bytes) -> str:
    """Stage takes any octets in comments and texts, as old files have them. Raises OSError for what is no text."""
    if b"\0" in octets:
        raise OSError(0, "it is no text")
    try:
        return octets.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError:
        return octets.decode("latin-1").replace("\r\n", "\n")


class _Parser:
    """Recursive descent over one world file and the files it includes."""

    def __init__(self, world: Path) -> None:
        self.remarks: list[Remark] = []
        self._world = world
        self._definitions: dict[str, _Definition] = {}
        self._in_use: list[str] = []
        self._open_files: list[Path] = []
        self._depth = 0  # of blocks
        self._blocks = self._files = 0  # so far

    def parse_file(self, path: Path, into: Block, place: Place | None = None) -> None:
        where: Place | str = place if place is not None else str(path)
        resolved = path.resolve()
        if resolved in self._open_files:
            cycle = " -> ".join(p.name for p in [*self._open_files[self._open_files.index(resolved) :], resolved])
            raise WorldFileError(where, f"include cycle: {cycle}")
        if len(self._open_files) >= MAX_INCLUDE_DEPTH:
            raise WorldFileError(where, f"includes are nested deeper than {MAX_INCLUDE_DEPTH} files")
        self._files += 1
        if self._files > MAX_INCLUDES:
            raise WorldFileError(
                where, f"more than {MAX_INCLUDES} files are included: is one included again and again?"
            )
        try:
            text = _decoded(path.read_bytes())
        except FileNotFoundError:
            raise WorldFileError(where, f'no such file: "{path}"') from None
        except OSError as error:
            raise WorldFileError(where, f'cannot read "{path}": {error.strerror}') from None
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
        name = following.text.strip('"')
        found = find_file(name, self._world, path) or _on_stage_path(name)
        if found is None:
            others = "STAGEPATH, the project's worlds"
            raise WorldFileError(following.place, f'no such file: "{path.parent / name}", nor in {others}')
        self.parse_file(found, into, following.place)
        return at + 2

    def _define(self, tokens: Sequence[_Token], at: int, path: Path) -> int:
        place = tokens[at].place
        words = tokens[at + 1 : at + 4]
        if [token.kind for token in words] != ["word", "word", "bracket"] or words[2].text != "(":
            raise WorldFileError(place, "define needs a name, a model and a block: define NAME MODEL ( ... )")
        name, end, depth = words[0].text, at + 4, 1
        while end < len(tokens) and depth:
            depth += {"(": 1, ")": -1}.get(tokens[end].text, 0)
            end += 1
        if depth:
            raise WorldFileError(words[1].place, f'the block of "{name}" is never closed')
        if name not in self._definitions:
            self._definitions[name] = _Definition(tokens[:end], at + 2, path)
        elif not self._same(self._definitions[name], tokens[at + 2 : end]):
            self.remarks.append(Remark(place, f'"{name}" is defined already and stays as it was'))
        return end

    @staticmethod
    def _same(definition: _Definition, tokens: Sequence[_Token]) -> bool:
        return [token.text for token in definition.tokens[definition.at :]] == [token.text for token in tokens]

    def _block(self, tokens: Sequence[_Token], at: int, into: Block, path: Path) -> int:
        if self._depth >= MAX_BLOCK_DEPTH:
            raise WorldFileError(tokens[at].place, f"blocks are nested deeper than {MAX_BLOCK_DEPTH}")
        self._blocks += 1
        if self._blocks > MAX_BLOCKS:
            raise WorldFileError(
                tokens[at].place, f"there are more than {MAX_BLOCKS} blocks, with those of definitions"
            )
        self._depth += 1
        block = self._open_block(tokens[at], into)
        end = self._statements(tokens, at + 2, block, path)
        if end >= len(tokens):
            raise WorldFileError(tokens[at].place, f'the block of "{tokens[at].text}" is never closed')
        self._depth -= 1
        return end + 1

    def _open_block(self, token: _Token, into: Block) -> Block:
        """A new child of `into`, with all that the definition of its name, if it has one, says."""
        definition = self._definitions.get(token.text)
        if definition is None:
            if token.text not in BLOCK_KINDS - {"world"}:
                raise WorldFileError(token.place, f'unknown model "{token.text}"{self._meant(token.text)}')
            block = Block(token.text, token.text, token.place)
            into.children.append(block)
            return block
        if token.text in self._in_use:
            raise WorldFileError(token.place, f'"{token.text}" is defined by itself')
        self._in_use.append(token.text)
        count = len(into.children)
        self._block(definition.tokens, definition.at, into, definition.path)
        self._in_use.pop()
        block = into.children[count]
        block.word, block.place = token.text, token.place
        return block

    def _meant(self, word: str) -> str:
        meant = nearest(word, BLOCK_KINDS.union(self._definitions))
        return f', did you mean "{meant}"?' if meant else ": is its definition's file included?"

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


@dataclass(frozen=True)
class WorldFile:
    """What a world file says: `root` is the block of kind "world", whose properties are the world's and whose children
    are the models in file order."""

    path: Path
    root: Block
    remarks: tuple[Remark, ...]


def parse_world_file(path: str | Path) -> WorldFile:
    """Parse a world file with everything it includes. Raises WorldFileError with file, line and word."""
    root = Block("world", "world", Place(str(path), 1))
    parser = _Parser(Path(path))
    parser.parse_file(Path(path), root)
    return WorldFile(Path(path), root, tuple(parser.remarks))
