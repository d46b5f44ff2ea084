"""`python3 -m explorer`: frontiers of map files and recorded decisions, without ROS."""

import sys

from explorer.command_line.arguments import main

if __name__ == "__main__":
    sys.exit(main())
