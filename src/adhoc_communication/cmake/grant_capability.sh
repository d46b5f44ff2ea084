#!/bin/sh
# Lets an executable open raw sockets without root: grant_capability.sh EXECUTABLE
# Does nothing where this may not be done, or where the file system or the container's limits make a program that has
# the capability fail to start.
setcap cap_net_raw+ep "$1" 2>/dev/null || exit 0
"$1" --list-parameters >/dev/null 2>&1 || setcap -r "$1"
