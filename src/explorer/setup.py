from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["explorer", "explorer.command_line", "explorer.strategies"], package_dir={"": "src"}
    )
)
