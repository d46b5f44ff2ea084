from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["mr_sim", "mr_sim.nuisance"], package_dir={"": "src"}))
