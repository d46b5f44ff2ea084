"""Every command of the pages exists: packages, executables, launch files and their arguments, options, make targets,
scripts. Nothing is run here: see `test/commands`."""

import importlib.util
import re
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import pytest
from pages import REPOSITORY, commands, pages

PACKAGES = {path.parent.name if path.parent.name != "test" else "mr_test": path.parent
            for path in [*REPOSITORY.glob("src/*/package.xml"), REPOSITORY / "test" / "package.xml"]}  # fmt: skip
OF_THE_SYSTEM = {"rviz", "tf2_tools", "topic_tools"}  # packages of ROS that the pages use
BUILT = {
    "adhoc_communication": {"adhoc_communication", "radio", "send_string", "bench_medium"}
}  # executables of C++, see CMakeLists.txt
PAGES = pytest.mark.parametrize("page", pages(), ids=lambda page: str(page.relative_to(REPOSITORY)))


def wrong(page, check):
    return "\n".join(f"{command}: {fault}" for command in commands(page) for fault in [check(command.words)] if fault)


@lru_cache(maxsize=None)
def sources(package):
    """Text of all that may hold options of a package's programs."""
    folder = PACKAGES[package]
    files = [path for place in ("src", "nodes", "scripts", "examples") for path in (folder / place).rglob("*")]
    texts = (path.read_text(encoding="utf-8", errors="ignore") for path in files if is_source(path))
    return "\n".join(texts)


def is_source(path: Path) -> bool:
    return path.is_file() and path.suffix in ("", ".py", ".cpp", ".hpp")


def executables(package):
    folder = PACKAGES[package]
    scripts = {path.name for place in ("nodes", "scripts", "examples") for path in (folder / place).glob("*")}
    return scripts | BUILT.get(package, set())


def check_rosrun(words):
    if words[0] != "rosrun" or len(words) < 3 or words[1] in OF_THE_SYSTEM:
        return ""
    package, program = words[1:3]
    if package not in PACKAGES:
        return f"there is no package {package}"
    if program not in executables(package):
        return f"{package} has no executable {program}"
    names = [word.partition("=")[0] for word in own_words(words)[3:] if re.match(r"--[a-z]", word)]
    text = sources(package)
    missing = [
        name for name in names if not re.search(rf"[\"'(\s]{name}[\"' =,]", text) and name[2:] not in plain(text)
    ]
    return f"{program} has no option {', '.join(missing)}" if missing else ""


def own_words(words):
    """Without the command that `enter` runs."""
    return words[:3] if words[1:3] == ("mr_launch", "enter") else words


def plain(text):
    """Options of C++ programs are listed without their dashes."""
    return set(re.findall(r"\"([a-z][a-z0-9-]+)\"", text)) | {"help"}


def launch_arguments(file):
    return {arg.get("name") for arg in ElementTree.parse(file).getroot().findall("arg")}


def check_roslaunch(words):
    if words[0] != "roslaunch":
        return ""
    rest = [word for word in words[1:] if not word.startswith("-")]
    if len(rest) < 2:  # the command itself is talked about
        return ""
    package, name = rest[:2]
    if package not in PACKAGES:
        return f"there is no package {package}"
    file = PACKAGES[package] / "launch" / name
    if not file.is_file():
        return f"{package} has no launch file {name}"
    unknown = {word.partition(":=")[0] for word in rest[2:] if ":=" in word} - launch_arguments(file)
    return f"no argument {', '.join(sorted(unknown))}" if unknown else ""


def check_make(words):
    if words[0] != "make":
        return ""
    text = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z][\w-]*):", text, re.MULTILINE))
    variables = set(re.findall(r"\$[({]?(?:if \$\()?([A-Z_]+)", text))
    options = words[3:] if words[1:2] == ("-C",) else words[1:]
    given = [word for word in options if not word.startswith("-")]
    unknown = [word for word in given if "=" not in word and word not in targets]
    unknown += [word for word in given if "=" in word and word.partition("=")[0] not in variables]
    return f"the Makefile has no {', '.join(unknown)}" if unknown else ""


def check_python(words):
    if words[0] != "python3":
        return ""
    if words[1] == "-m":
        name = words[2]
        own = any((folder / "src" / name / "__main__.py").is_file() for folder in PACKAGES.values())
        if not own and importlib.util.find_spec(name) is None:
            return f"there is no module {name}"
        words = words[2:] if name == "pytest" else ()
    files = [word for word in words[1:2] if re.match(r"(src|docs|test|tools)/", word)]
    return "; ".join(f"there is no {file}" for file in files if not (REPOSITORY / file).exists())


def check_script(words):
    files = [word for word in words if re.match(r"(\./)?(tools|docs/examples|worlds)/[\w./-]+$", word)]
    return "; ".join(f"there is no {file}" for file in files if not (REPOSITORY / file).exists())


@PAGES
@pytest.mark.parametrize("check", [check_rosrun, check_roslaunch, check_make, check_python, check_script])
def test_commands_exist(page, check):
    found = wrong(page, check)
    assert not found, found


@pytest.mark.parametrize(
    "check, line, fault",
    [
        (check_rosrun, "rosrun mr_launch teem", "mr_launch has no executable teem"),
        (check_rosrun, "rosrun mr_lunch team", "there is no package mr_lunch"),
        (check_rosrun, "rosrun mr_launch team --wrld x", "team has no option --wrld"),
        (check_rosrun, "rosrun mr_launch team --world x --no-bag", ""),
        (check_rosrun, "rosrun adhoc_communication radio --p-tx 15 --hubb x", "radio has no option --hubb"),
        (check_roslaunch, "roslaunch mr_launch robots.launch", "mr_launch has no launch file robots.launch"),
        (check_roslaunch, "roslaunch mr_launch robot.launch robbot:=x", "no argument robbot"),
        (check_make, "make demmo", "the Makefile has no demmo"),
        (check_make, "make -C ../before demmo", "the Makefile has no demmo"),
        (check_make, "make bench-buildings BUILDING=x", "the Makefile has no BUILDING=x"),
        (check_python, "python3 -m explorrer x", "there is no module explorrer"),
        (check_script, "tools/bench_mission --runs 3", "there is no tools/bench_mission"),
    ],
)
def test_wrong_commands_are_seen(check, line, fault):
    assert check(tuple(line.split())) == fault


def test_services_and_topics_of_the_pages_are_those_of_the_nodes():
    """Private names of the nodes of this project: the last element stands in the sources of the node."""
    unknown = []
    for page in pages():
        for command in commands(page):
            if command.words[0] not in ("rosservice", "rostopic"):
                continue
            for word in command.words[2:]:
                found = re.fullmatch(r"/(adhoc_communication|map_merger|explorer)/(\w+)", word)
                if found and not re.search(rf"\b{found.group(2)}\b", sources(found.group(1))):
                    unknown.append(f"{command}: {word}")
    assert not unknown, "\n".join(unknown)
