from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["mr_robot", "mr_robot.slam", "mr_robot.navigation", "mr_robot.platforms"], package_dir={"": "src"}
    )
)
