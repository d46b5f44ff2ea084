"""Words and models of Stage's world files: which have an effect here, and which are known but passed over."""

import difflib
import re
from collections.abc import Iterable

# --- Words with an effect, by kind of block ---

WORLD_WORDS = frozenset(
    {"resolution", "interval_sim", "speedup", "quit_time", "name", "unit_length", "unit_angle"}
)  # fmt: skip
MODEL_WORDS = frozenset(
    {
        "name", "pose", "size", "origin", "bitmap", "boundary", "noblocks", "obstacle_return", "ranger_return",
    }
)  # fmt: skip
POSITION_WORDS = MODEL_WORDS | {
    "drive", "localization", "localization_origin", "odom_error", "velocity_bounds", "update_interval",
}  # fmt: skip
GRIPPER_WORDS = frozenset({"paddle_size", "paddle_state"})
RANGER_WORDS = MODEL_WORDS | {
    "update_interval", "noise", "range", "range_min", "range_max", "fov", "samples", "scount", "spose", "sview",
}  # fmt: skip
SENSOR_WORDS = frozenset({"pose", "range", "fov", "samples", "noise"})
BLOCK_WORDS = frozenset({"points", "point"})

# --- Words without effect here ---

# acceleration_bounds is among them because Stage, too, heeds it only under acceleration control, which ROS never uses.
PASSED_OVER_WORDS = {
    "world": frozenset(
        {"show_clock", "show_clock_interval", "threads", "paused", "confirm_on_quit", "test"}
    ),
    "model": frozenset(
        {
            "alwayson", "blob_return", "color", "color_rgba", "ctrl", "debug", "event_queue", "fiducial_key",
            "fiducial_return", "friction", "give_watts", "gripper_return", "gui_grid", "gui_move", "gui_nose",
            "gui_outline", "joules", "joules_capacity", "kjoules", "kjoules_capacity", "map_resolution", "mass", "say",
            "stack_children", "take_watts", "trail_interval", "trail_length", "update_interval", "watts",
        }
    ),
    "position": frozenset({"acceleration_bounds", "velocity", "wheelbase"}),
    "sensor": frozenset({"size", "color", "color_rgba"}),
    "block": frozenset({"z", "color"}),
    "actuator": frozenset({"type", "axis", "min_position", "max_position", "max_speed", "start_position"}),
    "blinkenlight": frozenset({"enabled", "period", "dutycycle"}),
    "blobfinder": frozenset({"colors_count", "colors", "image", "range", "fov", "pan"}),
    "bumper": frozenset({"bcount", "bpose", "blength"}),
    "camera": frozenset({"resolution", "range", "fov", "pantilt"}),
    "fiducial": frozenset({"range_min", "range_max", "range_max_id", "fov", "ignore_zloc"}),
    "gripper": frozenset({"autosnatch"}),
}  # fmt: skip
"""What Stage 4.3 reads, by kind of block; the words of a model hold for every other kind but the world too."""

OLDER_WORDS = frozenset(
    {
        "background", "block", "blocks", "channel_count", "channels", "db_count", "enable_velocity", "event_queues",
        "gravity_return", "gui_disable", "gui_interval",
        "gui_movemask", "interval_real", "laser_return", "laser_sample_skip", "line", "lines", "odom", "origin3",
        "pose3", "ppm", "size3", "spose3", "sraycount", "ssize", "velocity_enable", "view", "wheel",
    }
)  # fmt: skip
"""Of Stage before 4.3 or of its documentation: Stage 4.3 does not read them either."""

# --- Models ---

DEFAULT_SIZES = {
    "ranger": (0.15, 0.15),
    "laser": (0.15, 0.15),
    "gripper": (0.2, 0.3),
    "camera": (0.1, 0.07),
    "blinkenlight": (0.02, 0.02),
}
"""m, where a world file gives none; of other models `DEFAULT_SIZE`."""
DEFAULT_SIZE = (0.4, 0.4)
BODILESS = frozenset({"ranger", "laser", "fiducial", "blobfinder", "wifi", "power", "speech"})
"""Models that have a body only if they have blocks."""
PASSED_OVER_MODELS = frozenset(
    {
        "actuator", "blinkenlight", "blobfinder", "bumper", "camera", "charger", "fiducial", "gripper",
        "lightindicator", "loadcell", "power", "speech", "wifi",
    }
)  # fmt: skip
"""Models that do nothing here; their bodies stay. Those Stage 4.3 does not know are of older ones."""
MODEL_KINDS = PASSED_OVER_MODELS | {"model", "position", "ranger", "laser"}
BLOCK_KINDS = MODEL_KINDS | {"world", "sensor", "block", "window"}

_LIKENESS = 0.8  # of a misspelling and its word, as difflib counts
_SHORT = 4  # letters of words of which one wrong letter is more than _LIKENESS allows


def stem_of(word: str) -> str:
    """`point` for `point[3]`, `block` for `block[0].points`."""
    return re.sub(r"\[.*", "", word)


def words_of(kind: str) -> frozenset:
    """All words, without their index, that Stage 4.3 knows in a block of this kind, and those with an effect here."""
    effective = {
        "world": WORLD_WORDS, "sensor": SENSOR_WORDS, "block": BLOCK_WORDS, "position": POSITION_WORDS,
        "ranger": RANGER_WORDS, "laser": RANGER_WORDS, "gripper": MODEL_WORDS | GRIPPER_WORDS,
    }.get(kind, MODEL_WORDS)  # fmt: skip
    passed_over = PASSED_OVER_WORDS.get(kind, frozenset())
    return effective | passed_over | (PASSED_OVER_WORDS["model"] if kind in MODEL_KINDS else frozenset())


KNOWN_WORDS = OLDER_WORDS.union(*(words_of(kind) for kind in BLOCK_KINDS))
"""Of any kind of block: where they have no effect they are out of place, but not misspelled."""


def nearest(word: str, known: Iterable[str]) -> str:
    """The known word most like this one, or empty if none is."""
    words = sorted(known)
    alike = difflib.get_close_matches(word, words, 1, _LIKENESS)
    return next(iter(alike), "") or next((each for each in words if _is_one_slip(word, each)), "")


def _is_one_slip(word: str, meant: str) -> bool:
    """Whether one letter is wrong, or two are swapped, in a short word."""
    if len(word) != len(meant) or not 2 < len(meant) <= _SHORT:
        return False
    wrong = [at for at, (one, other) in enumerate(zip(word, meant, strict=True)) if one != other]
    if len(wrong) == 2:
        return wrong[1] == wrong[0] + 1 and word[wrong[0]] + word[wrong[1]] == meant[wrong[1]] + meant[wrong[0]]
    return len(wrong) == 1
