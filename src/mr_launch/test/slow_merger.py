"""A stand-in for map_merger in replays: it needs as long to catch up as the file `held` is there, and tells the time up
to which it has, and the newest one, in the file `times`. Once the file `anew` is there it begins anew, as map_merger
does when the local map is another one."""

import os
import sys
import time
from pathlib import Path

import rospy
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty, EmptyResponse

HELD, TIMES, ANEW = map(Path, sys.argv[1:4])


def catch_up(_):
    if ANEW.exists():
        ANEW.unlink()
        os.execv(sys.executable, [sys.executable, *sys.argv])
    begun = rospy.get_time()
    while HELD.exists() and not rospy.is_shutdown():
        tell(begun)
        time.sleep(0.02)
    tell(rospy.get_time())
    return EmptyResponse()


def tell(caught_up):
    part = TIMES.with_suffix(".part")
    part.write_text(f"{caught_up} {rospy.get_time()}")
    part.rename(TIMES)


rospy.init_node("map_merger")
rospy.Subscriber("base_scan", LaserScan, lambda _: None, queue_size=1)
rospy.Service("~catchUp", Empty, catch_up)
rospy.spin()
