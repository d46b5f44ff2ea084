"""Nodes that must not start."""

import subprocess


def refused(case, node, *arguments):
    """What a node of mr_sim says on stderr when it refuses to start, with exit code 1 and without a traceback. `case`:
    the unittest.TestCase that asks."""
    program = subprocess.run(
        ["rosrun", "mr_sim", node, "__name:=refused", *arguments], capture_output=True, text=True, timeout=60
    )
    case.assertEqual(program.returncode, 1)
    case.assertNotIn("Traceback", program.stdout + program.stderr)
    return program.stderr
