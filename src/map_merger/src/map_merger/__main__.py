"""`python3 -m map_merger`: registers and merges map files without ROS."""

import sys

try:
    from .command_line.arguments import main
except ImportError as error:
    sys.exit(f"map_merger: {error}: build first (make build), then source tools/environment.sh")

if __name__ == "__main__":
    sys.exit(main())
