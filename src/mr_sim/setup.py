from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["mr_sim", "mr_sim.slam", "mr_sim.navigation", "mr_sim.nuisance", "mr_sim.platforms"],
        package_dir={"": "src"},
    )
)
