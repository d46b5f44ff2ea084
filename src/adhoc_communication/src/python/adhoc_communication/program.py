"""How a program of this stack begins: with Ctrl-C in force before anything is imported that takes time.

Imports may lose a KeyboardInterrupt, or end in its traceback. This module imports only what is Python's own.
"""

import importlib
import os
import signal
import sys
from typing import Any, Callable, NoReturn


def run_program(main: str, *arguments: Any, winds_up: bool = False, first: str = "") -> NoReturn:
    """Imports `main` and ends the program with what it returns for the arguments.

    `main` and `first` name a function as "module:function", or a module whose function `main` is meant. `first` is
    called before `main` is imported.

    Ctrl-C ends the program at once while it imports. Afterwards it is a KeyboardInterrupt in `main` of a program that
    `winds_up`, and ends any other until that takes signals itself, as nodes do when they begin. Where Ctrl-C is
    ignored, as behind a shell's &, it stays so.
    """
    at_interrupt = signal.getsignal(signal.SIGINT)
    if at_interrupt is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if first:
        _function(first)()
    called = _function(main)
    if winds_up:
        signal.signal(signal.SIGINT, at_interrupt)
    sys.exit(called(*arguments))


def run_node(main: str, description: str) -> NoReturn:
    """As `run_program` a node of ROS, which takes no options. `main` begins with the name of the package.

    Asked for --help, it prints `description` and ends, without a master.
    """
    if {"-h", "--help"} & set(sys.argv[1:]):
        package, name = main.split(".")[0], os.path.basename(sys.argv[0])
        print(f"usage: rosrun {package} {name} [_PARAMETER:=VALUE ...] [NAME:=NEW_NAME ...]\n\n{description.strip()}")
        print("\nA node of ROS: it waits for a master (roscore, or a launch file) and runs until it is told to end.")
        sys.exit(0)
    run_program(main)


def _function(name: str) -> Callable[..., Any]:
    module, _, function = name.partition(":")
    found: Callable[..., Any] = getattr(importlib.import_module(module), function or "main")
    return found
