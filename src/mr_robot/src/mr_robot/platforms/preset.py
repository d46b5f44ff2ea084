"""Preset files: the description of a kind of robot as YAML. `robots/template.yaml` explains every word."""

import math
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Union

import yaml  # type: ignore[import-untyped]

from mr_robot.platforms.platform import Drive, Footprint, Frames, Mount, Platform, PlatformError, RangeSensor, Topics

TEMPLATE = "template"


class _Number(NamedTuple):
    """A number from `low` to `high`, both included; without a default it has to be given."""

    low: float
    high: float
    unit: str
    default: Optional[float] = None


class _Name(NamedTuple):
    """Of a frame or a topic; without a default it has to be given."""

    default: Optional[str] = None


_NAME = _Name()
_Word = Union[_Number, _Name]
WORDS: Dict[str, Dict[str, _Word]] = {
    "footprint": {
        "length": _Number(0.05, 3.0, "m", 0.0),
        "width": _Number(0.05, 3.0, "m", 0.0),
        "radius": _Number(0.025, 3.0, "m", 0.0),
        "diameter": _Number(0.05, 3.0, "m", 0.0),
    },
    "sensor": {
        "range_min": _Number(0.0, 2.0, "m"),
        "range_max": _Number(1.0, 200.0, "m"),
        "field_of_view": _Number(0.1, 6.2832, "rad"),
        "noise": _Number(0.0, 0.2, "m"),
        "noise_share": _Number(0.0, 0.1, "of the range", 0.0),
    },
    "drive": {
        "max_linear_velocity": _Number(0.05, 5.0, "m/s"),
        "max_angular_velocity": _Number(0.1, 20.0, "rad/s"),
        "linear_acceleration": _Number(0.05, 20.0, "m/s^2"),
        "angular_acceleration": _Number(0.1, 100.0, "rad/s^2"),
    },
    "frames": {"base": _NAME, "odom": _NAME},
    "topics": {"scan": _NAME, "odometry": _NAME, "velocity": _NAME},
    "mount": {
        "frame": _Name(Mount.frame),
        "x": _Number(-3.0, 3.0, "m", Mount.x),
        "y": _Number(-3.0, 3.0, "m", Mount.y),
        "z": _Number(0.0, 3.0, "m", Mount.z),
        "yaw": _Number(-3.1416, 3.1416, "rad", Mount.yaw),
    },
}
"""Of a preset, by section. All sections and all words are needed but those with a default and these:"""
OPTIONAL_SECTIONS = ("mount",)

_OTHER_UNIT = {"m": (0.001, "mm"), "rad": (math.pi / 180.0, "degrees"), "rad/s": (math.pi / 180.0, "degrees/s")}


def platform_folders() -> List[Path]:
    """Folders with presets, nearest first: `robots/` of the source tree, `share/mr_robot/robots` when installed."""
    parents = Path(__file__).resolve().parents
    candidates = [parent / place for parent in parents for place in ("robots", "share/mr_robot/robots")]
    return [folder for folder in candidates if (folder / f"{TEMPLATE}.yaml").is_file()]


def find_platform(name: str) -> Path:
    """Path of a preset: `name` is a path or the name of one that comes with the package. Raises PlatformError."""
    if os.sep in name or name.endswith((".yaml", ".yml")):
        if Path(name).is_file():
            return Path(name)
        raise PlatformError(f"no robot {name!r}: there is no such file")
    presets = {path.stem: path for folder in reversed(platform_folders()) for path in folder.glob("*.yaml")}
    presets.pop(TEMPLATE, None)
    if name not in presets:
        raise PlatformError(
            f"no robot {name!r}: there are {', '.join(sorted(presets))}; or give the path of a preset file"
        )
    return presets[name]


def load_platform(name: str) -> Platform:
    """`name`: as for `find_platform`. Raises PlatformError, which names file, word and remedy."""
    path = find_platform(name)
    try:
        given = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise PlatformError(f"{path} cannot be read: {error}") from None
    except yaml.YAMLError as error:
        raise PlatformError(f"{path} is no YAML: {' '.join(str(error).split())}") from None
    try:
        return platform_from(given)
    except PlatformError as error:
        raise PlatformError(f"{path}: {error}") from None


def platform_from(given: Any) -> Platform:
    """From what a preset file says. Raises PlatformError for the first word that is missing, unknown or wrong."""
    sections = _mapping(given, WORDS, "")
    values = {name: _section(name, sections.get(name, {})) for name in WORDS}
    sensor = RangeSensor(**values["sensor"])
    if sensor.range_min >= sensor.range_max:
        raise PlatformError(f"sensor/range_min must be less than sensor/range_max, {sensor.range_max:g} m")
    return Platform(
        _footprint(values["footprint"]),
        sensor,
        Drive(**values["drive"]),
        Frames(**values["frames"]),
        Topics(**values["topics"]),
        Mount(**values["mount"]),
    )


def checked(platform: Platform) -> Platform:
    """The same. Raises PlatformError for one that no preset file can describe, of which the ROS stack makes one."""
    platform_from(yaml.safe_load(text_of(platform)))
    return platform


def text_of(platform: Platform) -> str:
    """The platform as a preset file."""
    sections = asdict(platform)
    footprint = platform.footprint
    if footprint == Footprint.disc(footprint.length):
        sections["footprint"] = {"diameter": footprint.length}
    elif footprint.is_box:
        del sections["footprint"]["radius"]
    return yaml.safe_dump(sections, sort_keys=False)


def _section(name: str, given: Any) -> Dict[str, Any]:
    words = WORDS[name]
    found = _mapping(given, words, f"{name}/")
    return {word: _value(f"{name}/{word}", rule, found) for word, rule in words.items()}


def _mapping(given: Any, known: Mapping[str, Any], prefix: str) -> Mapping[str, Any]:
    """Of known words only, with none missing that has no default."""
    where = f"{prefix[:-1]} must hold" if prefix else "a preset holds"
    if not isinstance(given, dict):
        raise PlatformError(f"{where} {', '.join(known)}, not {given!r:.60}")
    for word in given:
        if word not in known:
            raise PlatformError(f"{prefix}{word} is unknown; {where} {', '.join(known)}")
    for word, rule in known.items():
        needed = prefix + word not in OPTIONAL_SECTIONS and getattr(rule, "default", None) is None
        if needed and word not in given:
            raise PlatformError(f"{prefix}{word} is missing; robots/{TEMPLATE}.yaml explains it")
    return given


def _value(word: str, rule: _Word, found: Mapping[str, Any]) -> Any:
    value = found.get(word.split("/")[1])
    if value is None and rule.default is not None:
        return rule.default
    if isinstance(rule, _Number):
        return _number(word, rule, value)
    if not isinstance(value, str) or not value.strip("/") or " " in value:
        raise PlatformError(f"{word} must be a name, such as {_EXAMPLES[word]}, not {value!r}")
    return value


_EXAMPLES = {
    "frames/base": Frames.base, "frames/odom": Frames.odom,
    "mount/frame": Mount.frame,
    "topics/scan": Topics.scan, "topics/odometry": Topics.odometry, "topics/velocity": Topics.velocity,
}  # fmt: skip


def _number(word: str, rule: _Number, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not rule.low <= value <= rule.high:
        hint = ""
        factor, unit = _OTHER_UNIT.get(rule.unit, (0.0, ""))
        if isinstance(value, (int, float)) and factor and rule.low <= value * factor <= rule.high:
            hint = f" ({value:g} {unit} are {value * factor:.3g} {rule.unit})"
        raise PlatformError(
            f"{word} must be a number from {rule.low:g} to {rule.high:g} {rule.unit}, not {value!r}{hint}"
        )
    return float(value)


def _footprint(values: Mapping[str, float]) -> Footprint:
    length, width, radius, diameter = (values[word] for word in ("length", "width", "radius", "diameter"))
    if bool(diameter) == bool(length) or bool(length) != bool(width) or (radius and diameter):
        raise PlatformError("footprint needs either length and width, or diameter")
    if diameter:
        return Footprint.disc(diameter)
    box = Footprint.box(length, width)
    if radius and not max(length, width) / 2.0 <= radius <= box.radius:
        raise PlatformError(
            f"footprint/radius must be from half the longer side, {max(length, width) / 2.0:g} m, to half the "
            f"diagonal, {box.radius:g} m, not {radius:g}"
        )
    return Footprint(length, width, radius) if radius else box
