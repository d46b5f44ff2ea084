"""Drivers and SLAM of a simulated robot in one node, for the doctor. The parameter ~faults, a list, says what
is wrong from the next moment on: clock, scan, stamps, double, slow (odometry), unmounted (laser)."""

import math
import time

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

CHAIN = {"odom": "map", "base_footprint": "odom", "laser": "base_footprint"}


def transforms(stamp, chain):
    for child, parent in chain.items():
        transform = TransformStamped(child_frame_id=child)
        transform.header.frame_id, transform.header.stamp = parent, stamp
        transform.transform.rotation.w = 1.0
        yield transform


def main():
    rospy.init_node("slam", disable_rostime=True)
    clock = None
    scans = rospy.Publisher("scan", LaserScan, queue_size=1)
    ways = rospy.Publisher("odom", Odometry, queue_size=1)
    maps = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
    rospy.Subscriber("cmd_vel", Twist, lambda _: None)
    broadcaster = tf2_ros.TransformBroadcaster()
    maps.publish(OccupancyGrid())
    rate = rospy.Rate(10.0)
    turn = 0
    while not rospy.is_shutdown():
        faults = rospy.get_param("~faults", [])
        if "clock" not in faults:
            clock = clock or rospy.Publisher("/clock", Clock, queue_size=1)
            clock.publish(rospy.Time.from_sec(time.time()))
        elif clock:
            clock.unregister()
            clock = None
        now = rospy.Time.from_sec(time.time()) - rospy.Duration(5.5 if "stamps" in faults else 0.0)
        scan = LaserScan(range_min=0.1, range_max=8.0, angle_max=math.pi, ranges=[1.0] * 10)
        scan.header.stamp, scan.header.frame_id = now, "laser"
        if "scan" not in faults:
            scans.publish(scan)
        way = Odometry()
        way.header.stamp, way.header.frame_id = now, "odom"
        if turn % 10 == 0 or "slow" not in faults:
            ways.publish(way)
        turn += 1
        chain = {**CHAIN, **({"laser": "map"} if "double" in faults else {})}
        sent = [*transforms(now, CHAIN), *transforms(now, chain)]
        broadcaster.sendTransform([one for one in sent if one.child_frame_id != "laser" or "unmounted" not in faults])
        rate.sleep()


if __name__ == "__main__":
    main()
