from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["mr_page"], package_dir={"": "src"}, package_data={"mr_page": ["web/*"]}))
