"""A ROS master of a test's own on a free port, and processes that belong to it."""

import os
import signal
import subprocess
import time
import xmlrpc.client

from mr_launch.programs import free_ports


class LiveMaster:
    """`folder` takes logs; processes are ended in the order opposite to that of their start."""

    def __init__(self, folder):
        self.folder, self.processes = folder, {}
        (port,) = free_ports(1)
        self.environment = {
            **os.environ, "ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost",
            "ROS_LOG_DIR": str(folder), "ROS_HOME": str(folder),
        }  # fmt: skip
        self._master = xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"])
        # No roscore: one that is interrupted while it starts its nodes hangs, and leaves its master behind.
        self.start("core", "rosmaster", "--core", "-p", str(port))
        self.wait_for(lambda: self._ask("getPid"))

    def start(self, name, *command):
        with (self.folder / f"{name}.output").open("wb") as output:
            self.processes[name] = subprocess.Popen(
                [str(word) for word in command], env=self.environment, cwd=self.folder, stdout=output, stderr=output
            )

    def kill(self, *names):
        for name in names:
            self.processes[name].kill()
            self.processes[name].wait()

    def run(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60, check=False)

    def set(self, **parameters):
        """`node__name=value` for the parameter /node/name."""
        for name, value in parameters.items():
            self._ask("setParam", "/" + name.replace("__", "/"), value)

    def forget(self, *names):
        for name in names:
            self._ask("deleteParam", "/" + name.replace("__", "/"))

    def published(self):
        """Names of topics."""
        publishers, _, _ = self._ask("getSystemState")
        return [topic for topic, _ in publishers]

    def _ask(self, question, *words):
        """What the master answers; None where it does not."""
        try:
            code, _, answer = getattr(self._master, question)("/test", *words)
        except OSError:
            return None
        return answer if code == 1 else None

    def wait_for(self, done):
        end = time.monotonic() + 30.0
        while not done():
            assert time.monotonic() < end, "not ready"
            time.sleep(0.1)

    def wait_for_node(self, name):
        self.wait_for(lambda: self._ask("lookupNode", name))

    def close(self):
        for process in reversed(list(self.processes.values())):
            process.send_signal(signal.SIGINT)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
