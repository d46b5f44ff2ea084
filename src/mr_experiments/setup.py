from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

FOLDERS = (
    "bench",
    "common",
    "host",
    "host.fast",
    "publish",
    "replay",
    "report",
    "sweep",
    "trial",
    "worlds",
)

setup(
    **generate_distutils_setup(
        packages=["mr_experiments", *(f"mr_experiments.{folder}" for folder in FOLDERS)],
        package_dir={"": "src"},
    )
)
