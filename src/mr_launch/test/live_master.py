"""A ROS master of a test's own on a free port, and processes that belong to it."""

import os
import signal
import subprocess
import time

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
        self.start("core", "roscore", "-p", str(port))
        self.wait_for(lambda: self.run("rosparam", "get", "/run_id").returncode == 0)

    def start(self, name, *command):
        with (self.folder / f"{name}.output").open("wb") as output:
            self.processes[name] = subprocess.Popen(
                [str(word) for word in command], env=self.environment, cwd=self.folder, stdout=output, stderr=output
            )

    def run(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60, check=False)

    def set(self, **parameters):
        """`node__name=value` for the parameter /node/name."""
        for name, value in parameters.items():
            self.run("rosparam", "set", "/" + name.replace("__", "/"), str(value))

    def wait_for(self, done):
        end = time.monotonic() + 30.0
        while not done():
            assert time.monotonic() < end, "not ready"
            time.sleep(0.1)

    def wait_for_node(self, name):
        self.wait_for(lambda: name in self.run("rosnode", "list").stdout.split())

    def close(self):
        for process in reversed(list(self.processes.values())):
            process.send_signal(signal.SIGINT)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
