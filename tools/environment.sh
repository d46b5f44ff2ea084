# Source this: ROS of Debian, this build, and the system's own python3 first on PATH.
repository=$(cd "$(dirname "${BASH_SOURCE[0]:-$0}")/.." && pwd)
export PATH="/usr/bin:/bin:/usr/sbin:/sbin:$PATH"
export PYTHONNOUSERSITE=1
unset PYTHONHOME VIRTUAL_ENV
# Modules are compiled once, not by each of the many processes of a team or a test.
unset PYTHONDONTWRITEBYTECODE
# roslaunch imports distutils by way of rosclean; that of setuptools takes 12 MB in each of them, Python's own next to nothing.
export SETUPTOOLS_USE_DISTUTILS=stdlib
[ -e "$repository/build/devel/setup.sh" ] && . "$repository/build/devel/setup.sh"
export ROS_PACKAGE_PATH="${ROS_PACKAGE_PATH:-$repository/src:/usr/share}"
export PYTHONPATH="${PYTHONPATH:+$PYTHONPATH:}$repository/build/python_environment/lib/python$(/usr/bin/python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')/site-packages"
