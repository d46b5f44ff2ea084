"""A page as one HTML file without any external resource: style, data and modules of JavaScript are put into it.

The modules lie in `web/`. They use a part of the language only, which is checked here: `import { a, b } from "./x.js";`
in one line each, before everything else, and `export` before a function, class or const. So each can become a function
of a plain script, which browsers run from a file as well.
"""

from __future__ import annotations

import html
import json
import re
from functools import lru_cache
from pathlib import Path
from typing import Any

WEB = Path(__file__).parent / "web"
# For a browser the page is the only source of what it runs, and its server the only one that it talks to.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'"
IMPORT = re.compile(r'^import \{ ?([\w, ]+?) ?\} from "\./([\w/]+\.js)";$', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:async )?(?:function|class|const)) (\w+)", re.MULTILINE)


def self_contained(name: str, title: str, data: Any = None) -> str:
    """The page of the module `web/<name>.js`: the frame that pages share, `<name>.html` beside the map, the styles and
    data of plain JSON (None: none)."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    parts = {
        "policy": POLICY,
        "aside": _read(f"{name}.html"),
        "title": html.escape(title),
        "style": _read("page.css"),
        "data": text.replace("<", "\\u003c"),  # so that no name or text can end the script element
        "script": script(f"{name}.js"),
    }
    return re.sub(r"@@(\w+)@@", lambda match: parts[match.group(1)], _read("frame.html"))


@lru_cache(maxsize=8)
def script(main: str) -> str:
    """A plain script of a module and all that it imports. ValueError for what cannot be made part of one."""
    order: list[str] = []
    _visit(main, order, ())
    functions = [f"const {_name(module)} = {_function(module)};" for module in order]
    text = "\n".join(['"use strict";', "(() => {", *functions, "})();"])
    if "</script" in text.lower() or "<!--" in text:
        raise ValueError(f"the modules of {main} hold what ends a script element")
    return text


def _visit(module: str, order: list[str], above: tuple[str, ...]) -> None:
    """Adds a module to `order` behind all that it imports."""
    if module in above:
        raise ValueError(f"modules import one another: {' -> '.join((*above, module))}")
    if module in order:
        return
    for _, other in IMPORT.findall(_read(module)):
        _visit(other, order, (*above, module))
    order.append(module)


def _function(module: str) -> str:
    """A call of a function that runs the module and returns what it exports."""
    text = IMPORT.sub(lambda match: f"const {{ {match.group(1)} }} = {_name(match.group(2))};", _read(module))
    exported = [name for _, name in EXPORT.findall(text)]
    text = EXPORT.sub(r"\1 \2", text)
    left = re.search(r"^(import|export)\b.*", text, re.MULTILINE)
    if left:
        raise ValueError(f"{module}: {left.group(0)!r} cannot be put into a page; see mr_page.document")
    return f"(() => {{\n{text}\nreturn {{ {', '.join(exported)} }};\n}})()"


def _name(module: str) -> str:
    return "_" + re.sub(r"\W", "_", module.removesuffix(".js"))


def _read(name: str) -> str:
    return (WEB / name).read_text(encoding="utf-8")
