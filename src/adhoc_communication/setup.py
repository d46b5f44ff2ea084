from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["adhoc_communication"], package_dir={"": "src/python"}))
