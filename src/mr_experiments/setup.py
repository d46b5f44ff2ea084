from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["mr_experiments"], package_dir={"": "src"}, package_data={"mr_experiments": ["replay_page.*"]}
    )
)
