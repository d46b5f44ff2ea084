from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["mr_measures", "mr_measures.record"], package_dir={"": "src"}))
