#!/usr/bin/env python3
"""Sends a message of a type that adhoc_communication does not know to another robot: python3 send_battery.py ROBOT"""

import io
import sys

import rosgraph
import rospy
from adhoc_communication.srv import SendMessage, SendMessageRequest
from sensor_msgs.msg import BatteryState


def request_of(robot, topic, message):
    """What the service send_message takes for a message of any type."""
    octets = io.BytesIO()
    message.serialize(octets)
    kind = {"type": message._type, "md5sum": message._md5sum, "definition": message._full_text}
    return SendMessageRequest(dst_robot=robot, topic=topic, data=octets.getvalue(), **kind)


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if not rosgraph.is_master_online():  # rospy would try for ever
        print(f"not delivered: no ROS master at {rosgraph.get_master_uri()}: start adhoc.launch", file=sys.stderr)
        return 1
    rospy.init_node("send_battery", anonymous=True)
    service = "adhoc_communication/send_message"
    try:
        rospy.wait_for_service(service, timeout=5.0)
        rospy.ServiceProxy(service, SendMessage)(
            request_of(sys.argv[1], "team/battery", BatteryState(voltage=12.3, percentage=0.8))
        )
    except (rospy.ROSException, rospy.ServiceException) as error:
        print(f"not delivered: {error}", file=sys.stderr)
        return 1
    print("delivered")
    return 0


if __name__ == "__main__":
    sys.exit(main())
