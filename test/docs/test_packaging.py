"""Changelogs, Dockerfiles, the workflow and tools/test name what is there, and tools/test all of it."""

import ast
import re
import runpy

import pytest
import yaml
from pages import REPOSITORY

PACKAGES = sorted(path.parent for path in REPOSITORY.glob("src/*/package.xml"))


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.name)
def test_every_package_has_a_changelog(package):
    lines = (package / "CHANGELOG.rst").read_text(encoding="utf-8").splitlines()
    assert lines[1] == f"Changelog for package {package.name}" and set(lines[0]) == set(lines[2]) == {"^"}
    version = re.search(r"<version>(.*)</version>", (package / "package.xml").read_text(encoding="utf-8"))
    assert lines[4] == "Forthcoming" or lines[4].startswith(version.group(1))
    assert set(lines[5]) == {"-"} and len(lines[5]) == len(lines[4])
    assert all(line.startswith(("* ", "  ")) and len(line) <= 120 for line in lines[6:] if line)


@pytest.mark.parametrize("package", [p for p in PACKAGES if (p / "setup.py").exists()], ids=lambda p: p.name)
def test_every_folder_of_modules_is_installed(package):
    """The doctor, playback and the override of velocities were not: they ended in an ImportError."""
    given = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(package)
        patch.setattr("setuptools.setup", given.update)
        runpy.run_path("setup.py")
    root = package / given["package_dir"][""]
    folders = {file.parent.relative_to(root) for file in root.rglob("__init__.py")}
    assert sorted(given["packages"]) == sorted(".".join(folder.parts) for folder in folders)


def kinds_of_tests(package):
    """The kinds of tests of a package, as catkin names their targets."""
    text = "".join(path.read_text(encoding="utf-8") for path in package.glob("*.cmake"))
    text += (package / "CMakeLists.txt").read_text(encoding="utf-8")
    calls = {"catkin_add_gtest": "gtest", "add_rostest": "rostest", "roslaunch_add_file_check": "roslaunch-check"}
    found = {kind for call, kind in calls.items() if re.search(rf"\b{call}\(", text)}
    own = r"\b(?:catkin_run_tests_target|adhoc_add_tests|add_tests)\(\"?(\w+)\"? "
    return found | (set(re.findall(own, text)) - {"kind"})


@pytest.mark.parametrize("package", [*PACKAGES, REPOSITORY / "test"], ids=lambda package: package.name)
def test_every_kind_of_tests_is_run_by_make_test(package):
    text = (REPOSITORY / "tools" / "test").read_text(encoding="utf-8")
    name = re.search(
        r"^project\((\w+)\)", (package / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE
    ).group(1)
    if re.search(rf"^{name}$", text, re.MULTILINE):
        return
    lines = re.findall(rf"^(?:run_tests )?{name}((?: [\w-]+)+)", text, re.MULTILINE)
    run = [kind for kinds in lines for kind in kinds.split()]
    assert len(run) == len(set(run)) and set(run) == kinds_of_tests(package)


@pytest.mark.parametrize("file", sorted((REPOSITORY / "docker").glob("Dockerfile.*")), ids=lambda file: file.name)
def test_dockerfiles_copy_what_is_there(file):
    text = file.read_text(encoding="utf-8")
    for source in re.findall(r"^COPY (\S+) ", text, re.MULTILINE):
        assert (REPOSITORY / source).exists(), source
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"\bmake ([a-z][\w-]*)", text):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


def test_noetic_gets_all_packages_that_the_core_needs():
    copied = set(
        re.findall(r"^COPY src/(\w+) ", (REPOSITORY / "docker" / "Dockerfile.noetic").read_text(), re.MULTILINE)
    )
    own = {package.name for package in PACKAGES}
    for name in copied:
        text = (REPOSITORY / "src" / name / "package.xml").read_text(encoding="utf-8")
        needed = set(re.findall(r"<(?:build_|exec_)?depend>(\w+)<", text)) & own
        assert needed <= copied, f"{name} needs {needed - copied}"


# Of the packages of ros-base, on which Dockerfile.noetic builds.
OF_ROS_BASE = {
    "catkin", "geometry_msgs", "message_generation", "message_runtime", "rosgraph", "roscpp", "rospy", "std_msgs",
}  # fmt: skip
OPTIONAL = {"python3-rich": ("adhoc_communication/src/python/adhoc_communication/top.py", "from rich.")}
"""Keys that Ubuntu 20.04 has no package for, and where the program goes on without."""


def test_noetic_installs_what_the_core_needs_and_no_more():
    text = (REPOSITORY / "docker" / "Dockerfile.noetic").read_text(encoding="utf-8")
    words = re.search(r"apt-get install (.*?)&&", text.replace("\\\n", " "), re.DOTALL).group(1).split()
    installed = {word for word in words if not word.startswith("-")}
    table = (REPOSITORY / "tools" / "debian_packages.txt").read_text(encoding="utf-8").splitlines()
    debian = {key: set(packages) for key, *packages in (line.split() for line in table if not line.startswith("#"))}
    own = {package.name for package in PACKAGES}
    needed = {"build-essential", "cmake"}
    for name in re.findall(r"^COPY src/(\w+) ", text, re.MULTILINE):
        package = (REPOSITORY / "src" / name / "package.xml").read_text(encoding="utf-8")
        keys = re.findall(r"<(?:buildtool_|build_|build_export_|exec_)?depend>([^<]+)<", package)
        for key in set(keys) - own - OF_ROS_BASE - set(OPTIONAL):
            of_ros = "ros-noetic-" + key.replace("_", "-")
            packages = {of_ros} if of_ros in installed else debian[key]
            assert packages <= installed, f"{name} needs {key}: neither {of_ros} nor {sorted(packages)} is installed"
            needed |= packages
    assert installed == needed


@pytest.mark.parametrize("key", OPTIONAL)
def test_what_noetic_goes_without_is_imported_in_a_try(key):
    place, word = OPTIONAL[key]
    tree = ast.parse((REPOSITORY / "src" / place).read_text(encoding="utf-8"))
    guarded = [part for node in tree.body if isinstance(node, ast.Try) for part in node.body]
    assert any(ast.unparse(part).startswith(word) for part in guarded)
    assert not any(ast.unparse(part).startswith(word) for part in tree.body)
    assert key in (REPOSITORY / "docker" / "Dockerfile.noetic").read_text(encoding="utf-8")


def test_workflow_and_citation_can_be_read():
    workflow = yaml.safe_load((REPOSITORY / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))
    assert workflow["jobs"]["debian12"]["container"]["image"] == "debian:bookworm"
    commands = [step.get("run", "") for step in workflow["jobs"]["debian12"]["steps"]]
    assert "make test" in commands and "make lint" in commands
    for step in workflow["jobs"]["noetic"]["steps"]:
        for file in re.findall(r"-f (\S+)", step.get("run", "")):
            assert (REPOSITORY / file).is_file()
    assert "schedule" in workflow[True]  # YAML 1.1 takes "on" for a truth value
    assert "make nightly" in [step.get("run", "") for step in workflow["jobs"]["nightly"]["steps"]]
    for name, job in workflow["jobs"].items():
        assert job["if"] == f"github.event_name {'==' if name == 'nightly' else '!='} 'schedule'"
    citation = yaml.safe_load((REPOSITORY / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0" and citation["license"] == "BSD-3-Clause"
