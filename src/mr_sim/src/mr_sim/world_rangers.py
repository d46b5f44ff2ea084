"""Range finders of a world file: sensors of Stage 4, sonar rings and lasers of older files."""

import math

from mr_grid import Pose
from mr_sim.world_description import RangerDescription
from mr_sim.world_file import Block, WorldFileError
from mr_sim.world_reader import Context, Reader
from mr_sim.world_words import RANGER_WORDS, SENSOR_WORDS

MAX_SAMPLES = 20_000  # beams of a ranger: a sweep must fit into one packet of the world socket
MAX_RANGERS = 255  # sensors of a robot: the world socket numbers them by a byte

STAGE_FOV = 0.1  # rad, of a sensor that says nothing
SONAR_RANGE = (0.0, 5.0)  # m, of a ring that says nothing


def sensors_of(block: Block, context: Context) -> list[RangerDescription]:
    """One description per `sensor` block; without one, the older words of a sonar ring or of a laser."""
    reader = Reader(block, RANGER_WORDS, context)
    sensors = [child for child in block.children if child.kind == "sensor"]
    if not sensors:
        return _ring(reader) if reader.has("scount") else [_sensor(reader, reader, _mount(reader))]
    context.passed_over.words.update(
        word for word in ("range", "range_min", "range_max", "fov", "samples", "scount") if reader.has(word)
    )
    found = []
    for sensor in sensors:
        for child in sensor.children:
            raise WorldFileError(child.place, f'"{child.word}" inside a sensor is not supported')
        inner = Reader(sensor, SENSOR_WORDS, context)
        found.append(_sensor(inner, reader, _mount(reader).compose(inner.pose())))
    return found


def _mount(ranger: Reader) -> Pose:
    return ranger.pose().compose(ranger.origin())


def _ring(ranger: Reader) -> list[RangerDescription]:
    """Of sonars, as Stage before version 4 has it."""
    count = ranger.number("scount", 0.0, minimum=1.0)
    if count != int(count) or count > MAX_RANGERS:
        raise ranger.fail("scount", f"must be a whole number up to {MAX_RANGERS}, not {count:g}")
    nearest, farthest, view = ranger.numbers("sview", (*SONAR_RANGE, math.pi / count), "lla")
    poses = [ranger.numbers(f"spose[{index}]", (0.0, 0.0, 0.0), "lla") for index in range(int(count))]
    return [_description(ranger, ranger, _mount(ranger).compose(Pose(x, y, yaw)), "sview", (nearest, farthest), view, 1)
            for x, y, yaw in poses]  # fmt: skip


def _sensor(reader: Reader, ranger: Reader, mount: Pose) -> RangerDescription:
    nearest, farthest = reader.numbers("range", (0.0, 5.0), "ll")
    nearest = reader.length("range_min", nearest, minimum=0.0)
    farthest = reader.length("range_max", farthest)
    view = reader.numbers("fov", (STAGE_FOV,), "a")[0]
    samples = reader.number("samples", 1.0, minimum=1.0)
    if samples != int(samples) or samples > MAX_SAMPLES:
        raise reader.fail("samples", f"must be a whole number up to {MAX_SAMPLES}, not {samples:g}")
    word = "range" if reader.has("range") else "range_max"
    return _description(reader, ranger, mount, word, (nearest, farthest), view, int(samples))


def _description(
    reader: Reader, ranger: Reader, mount: Pose, range_word: str, limits: tuple[float, float], view: float, samples: int
) -> RangerDescription:
    """`limits` of the range in m; `view` in rad."""
    if limits[0] < 0.0 or limits[1] <= limits[0]:
        bounds = f"{limits[0]:g} to {limits[1]:g}"
        raise reader.fail(range_word, f"must go from a minimum >= 0 to a larger maximum, not {bounds}")
    if not (0.0 < view <= 2.0 * math.pi + 1e-9 or (view == 0.0 and samples == 1)):
        raise reader.fail("fov", f"must be above 0 and at most 360 degrees, not {math.degrees(view):g}")
    noisy = reader if reader.has("noise") else ranger
    noise = noisy.numbers("noise", (0.0, 0.0, 0.0), "lfa")
    if min(noise) < 0.0:
        raise noisy.fail("noise", "must not be negative")
    if noise[1] > 1.0:
        raise noisy.fail("noise", f"has a second number that is a share of the range, at most 1, not {noise[1]:g}")
    return RangerDescription(
        mount=mount,
        range_min=limits[0],
        range_max=limits[1],
        field_of_view=view,
        samples=samples,
        update_interval=ranger.interval("update_interval", 100.0),
        noise_variance=noise[0],
        noise_share=noise[1],
        noise_bearing=noise[2],
    )
