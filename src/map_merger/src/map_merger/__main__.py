"""`python3 -m map_merger`: registers and merges map files without ROS."""

import sys

from .command_line.arguments import main

if __name__ == "__main__":
    sys.exit(main())
