"""Modules of JavaScript become one plain script."""

import json
import shutil
import subprocess

import pytest

from mr_page import document
from mr_page.document import script


@pytest.fixture
def web(tmp_path, monkeypatch):
    monkeypatch.setattr(document, "WEB", tmp_path)
    script.cache_clear()
    yield tmp_path
    script.cache_clear()


def write(folder, **modules):
    for name, text in modules.items():
        (folder / f"{name}.js").write_text(text)


def test_modules_stand_before_those_that_use_them(web):
    write(
        web,
        a='import { b } from "./b.js";\nimport { c } from "./c.js";\nuse(b, c);\n',
        b='import { c } from "./c.js";\nexport const b = c + 1;\n',
        c="export const c = 1;\nexport function f() {}\nexport class D {}\n",
    )
    text = script("a.js")
    assert text.index("const _c =") < text.index("const _b =") < text.index("const _a =")
    assert "return { c, f, D };" in text and "import" not in text and "export" not in text


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ('import * as b from "./b.js";', "cannot be put into a page"),
        ("export default 3;", "cannot be put into a page"),
        ('const x = "</script>";', "ends a script element"),
        ('import { a } from "./a.js";', "import one another: a.js -> a.js"),
    ],
)
def test_what_cannot_be_is_named(web, text, part):
    write(web, a=text + "\n", b="export const b = 1;\n")
    with pytest.raises(ValueError, match=part):
        script("a.js")


def node(expression):
    """JSON of an expression in a module of JavaScript beside those of the page."""
    if shutil.which("node") is None:
        pytest.skip("node is not installed: run tools/install_dependencies browser")
    done = subprocess.run(
        ["node", "--input-type=module", "-e", f"{expression}"], cwd=document.WEB, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("main", ["status.js", "replay.js"])
def test_scripts_are_valid(tmp_path, main):
    if shutil.which("node") is None:
        pytest.skip("node is not installed: run tools/install_dependencies browser")
    path = tmp_path / "page.js"
    path.write_text(script(main))
    subprocess.run(["node", "--check", str(path)], check=True)


def test_browsers_read_updates_as_they_are_written():
    import numpy as np

    from mr_grid import OccupancyGrid, Pose
    from mr_page.state import PageState
    from mr_page.update import encoded
    from mr_page.viewer import Viewer

    state = PageState()
    state.put("robot_1", "text", "grün")
    state.append("robot_1", "trail", [1.5, 2.5])
    cells = np.full((70, 3), 100, dtype=np.int8)
    state.map("robot_1", "local").take(OccupancyGrid.of(cells, 0.05, Pose(1.0, 2.0, 0.5)))
    message = encoded(Viewer(state).update(0.0))
    found = node(
        'import { decoded } from "./connection.js";'
        f"const bytes = Uint8Array.from({list(message)});"
        "const update = decoded(bytes.buffer);"
        "const tiles = update.tiles.map((t) => ({ ...t, octets: [t.octets.length, t.octets[0]] }));"
        "console.log(JSON.stringify({ ...update, tiles }));"
    )
    assert found["robots"] == {"robot_1": {"values": {"text": "grün"}, "streams": {"trail": [0, [[1.5, 2.5]]]}}}
    assert found["maps"] == [["robot_1", "local", 0.05, 1.0, 2.0, 0.5]] and found["anew"] == ["robot_1"]
    assert [(tile["row"], tile["column"], tile["octets"]) for tile in found["tiles"]] == [
        (0, 0, [1024, 42]), (1, 0, [1024, 42]),
    ]  # fmt: skip
