#!/usr/bin/env python3
"""Sends a text to another robot: rosrun adhoc_communication send_string.py ROBOT TOPIC TEXT

The receiving robot publishes it as adhoc_communication/RecvString on TOPIC.
"""

import sys

import rospy
from adhoc_communication.srv import SendString


def main() -> int:
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    _, robot, topic, text = sys.argv
    rospy.init_node("send_string", anonymous=True)
    service = "adhoc_communication/send_string"
    try:
        rospy.wait_for_service(service, timeout=5.0)
        rospy.ServiceProxy(service, SendString)(robot, topic, text)
    except (rospy.ROSException, rospy.ServiceException) as error:
        print(f"not delivered: {error}", file=sys.stderr)
        return 1
    print("delivered")
    return 0


if __name__ == "__main__":
    sys.exit(main())
