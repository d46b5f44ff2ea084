"""Typed access to the words of a world file's blocks, in SI units, and what of them has no effect."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from mr_grid import Pose
from mr_sim.world_file import Block, Place, Property, WorldFileError
from mr_sim.world_words import KNOWN_WORDS, nearest, stem_of, words_of

SHORTEST, LONGEST = 0.01, 1.0e7  # ms of an interval, so that one has a number of steps that fits
LENGTH_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
ANGLE_UNITS = {"degrees": math.pi / 180.0, "radians": 1.0}


@dataclass
class PassedOver:
    """What a world file says without effect here, for one warning."""

    words: set[str] = field(default_factory=set)
    unknown: dict[str, Place] = field(default_factory=dict)
    models: set[str] = field(default_factory=set)
    remarks: list[str] = field(default_factory=list)

    def text(self) -> str:
        """One line, empty if all has an effect."""
        parts = []
        if self.models:
            parts.append("models " + ", ".join(sorted(self.models)))
        if self.words:
            parts.append("words " + ", ".join(sorted(self.words)))
        if self.unknown:
            unknown = (f"{word} ({place})" for word, place in sorted(self.unknown.items()))
            parts.append("unknown words " + ", ".join(unknown))
        lines = ["without effect here: " + "; ".join(parts)] if parts else []
        return "; ".join([*lines, *self.remarks])


@dataclass(frozen=True)
class Context:
    """What holds for a whole world file."""

    length: float = 1.0  # m, of the file's unit
    angle: float = ANGLE_UNITS["degrees"]  # rad, same
    passed_over: PassedOver = field(default_factory=PassedOver)

    @property
    def units(self) -> dict[str, float]:
        """By the letter of a unit: length, angle, plain number."""
        return {"l": self.length, "a": self.angle, "f": 1.0}


class Reader:
    """Typed access to the properties of one block, `words` of which have an effect. The others are noted as passed
    over; one that looks like a misspelling raises WorldFileError."""

    def __init__(self, block: Block, words: frozenset, context: Context) -> None:
        self.block = block
        self.context = context
        for word, entry in block.properties.items():
            stem = stem_of(word)
            if stem not in words:
                self._pass_over(stem, entry)

    def _pass_over(self, stem: str, entry: Property) -> None:
        if stem in KNOWN_WORDS:
            self.context.passed_over.words.add(stem)
            return
        refuse_misspelling(stem, entry, self.block, words_of(self.block.kind))
        self.context.passed_over.unknown.setdefault(stem, entry.place)

    def _entry(self, word: str) -> Property | None:
        return self.block.properties.get(word)

    def fail(self, word: str, message: str) -> WorldFileError:
        entry = self._entry(word)
        return WorldFileError(entry.place if entry else self.block.place, f'"{word}" {message}')

    def has(self, word: str) -> bool:
        return word in self.block.properties

    def text(self, word: str, default: str, choices: Sequence[str] = ()) -> str:
        entry = self._entry(word)
        if entry is None:
            return default
        if not isinstance(entry.value, str):
            raise self.fail(word, "needs a string in quotes")
        if choices and entry.value not in choices:
            listed = " or ".join(f'"{choice}"' for choice in choices)
            raise self.fail(word, f'must be {listed}, not "{entry.value}"')
        return entry.value

    def number(self, word: str, default: float, minimum: float = -math.inf, above: float = -math.inf) -> float:
        """As the file says it."""
        entry = self._entry(word)
        value = default if entry is None else entry.value
        if not isinstance(value, (int, float)):
            raise self.fail(word, "needs a number")
        if value < minimum or value <= above:
            bound = f"at least {minimum:g}" if value < minimum else f"greater than {above:g}"
            raise self.fail(word, f"must be {bound}, not {value:g}")
        return float(value)

    def length(self, word: str, default: float, minimum: float = -math.inf) -> float:
        """m, as is the default."""
        return self.number(word, default, minimum) * self.context.length if self.has(word) else default

    def numbers(self, word: str, default: Sequence[float], units: str) -> tuple[float, ...]:
        """As many numbers as letters in `units`, of which each is l for a length, a for an angle or f: in m, rad or as
        they are. As in Stage further numbers do not matter. The default is in m and rad."""
        entry = self._entry(word)
        if entry is None:
            return tuple(default)
        values = entry.value if isinstance(entry.value, tuple) else (entry.value,)
        if len(values) < len(units) or any(isinstance(value, str) for value in values):
            raise self.fail(word, f"needs {len(units)} numbers in [ ]")
        return tuple(float(value) * self.context.units[unit] for value, unit in zip(values, units, strict=False))

    def flag(self, word: str, default: bool) -> bool:
        return self.number(word, float(default)) != 0.0

    def pose(self, word: str = "pose") -> Pose:
        x, y, _, yaw = self.numbers(word, (0.0, 0.0, 0.0, 0.0), "llla")
        return Pose(x, y, yaw)

    def origin(self) -> Pose:
        """Stage's own files have it with three numbers; the heading is 0 then."""
        entry = self._entry("origin")
        if entry is not None and isinstance(entry.value, tuple) and len(entry.value) == 3:
            x, y, _ = self.numbers("origin", (), "lll")
            return Pose(x, y, 0.0)
        return self.pose("origin")

    def size(self, default: tuple[float, float]) -> tuple[float, float]:
        """Length and width in m; heights do not matter and may be missing."""
        x, y = self.numbers("size", default, "ll")
        if x < 0.0 or y < 0.0:
            raise self.fail("size", "must not be negative")
        return x, y

    def visible(self) -> bool:
        """Whether lasers see the model."""
        return self.number("ranger_return", 1.0) >= 0.0

    def ranger_return(self) -> float:
        """Intensity of the echo of a model that lasers see."""
        return self.number("ranger_return", 1.0)

    def interval(self, word: str, default: float) -> float:
        """s; the file and the default have ms."""
        value = self.number(word, default)
        if not SHORTEST <= value <= LONGEST:
            raise self.fail(word, f"must be from {SHORTEST:g} to {LONGEST:g} ms, not {value:g}")
        return value / 1000.0


def refuse_misspelling(word: str, entry: Property, block: Block, words: Iterable[str]) -> None:
    """Raises WorldFileError for a word that nobody knows and that looks like one of `words`."""
    stem = stem_of(word)
    statements = ("define", "include") if block.kind == "world" else ()
    meant = "" if stem in KNOWN_WORDS else nearest(stem, {*words, *statements})
    if meant:
        raise WorldFileError(entry.place, f'unknown word "{stem}" in "{block.word}", did you mean "{meant}"?')


def units_of(root: Block) -> tuple[float, float]:
    """Length in m and angle in rad of a world file's units."""
    units = {word: entry for word, entry in root.properties.items() if word in ("unit_length", "unit_angle")}
    reader = Reader(Block(root.kind, root.word, root.place, units), frozenset(units), Context())
    length = reader.text("unit_length", "m", tuple(LENGTH_UNITS))
    angle = reader.text("unit_angle", "degrees", tuple(ANGLE_UNITS))
    return LENGTH_UNITS[length], ANGLE_UNITS[angle]
