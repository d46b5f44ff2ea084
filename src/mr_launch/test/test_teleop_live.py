"""A person's velocities go before those of navigation, on a real master; the description becomes transforms."""

import subprocess
import sys

import pytest
from live_master import LiveMaster

from mr_launch.programs import find_executable

# Navigation drives at 0.5 m/s all the time; after 2 s a person turns the robot for a second and lets go.
DRIVE = """
import sys, time, rospy
from geometry_msgs.msg import Twist
rospy.init_node("drive", disable_rostime=True)
heard = []
rospy.Subscriber("base/velocity", Twist, lambda message: heard.append((message.linear.x, message.angular.z)))
navigation, person = (rospy.Publisher(name + "/cmd_vel", Twist, queue_size=1) for name in ("navigation", "teleop"))
ahead, turn = Twist(), Twist()
ahead.linear.x, turn.angular.z = 0.5, 1.0
end = time.monotonic() + 30.0
while not (heard and person.get_num_connections()):
    if time.monotonic() > end:
        sys.exit(f"override: {len(heard)} velocities heard, {person.get_num_connections()} connections to the person")
    navigation.publish(ahead)
    time.sleep(0.05)
for step in range(60):
    navigation.publish(ahead)
    if step < 20:
        person.publish(turn)
    time.sleep(0.05)
print(sorted(set(heard), key=heard.index), heard[-1])
"""


@pytest.fixture
def live(tmp_path):
    found = LiveMaster(tmp_path)
    yield found
    found.close()


def test_a_person_drives_before_navigation_and_the_sensor_has_its_place(live):
    words = [find_executable("mr_robot", "robot_parameters"), "--robot", "pioneer", "--urdf"]
    urdf = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=True).stdout
    live.run("rosparam", "set", "/robot_description", urdf)
    live.set(velocity_override__velocity_topic="base/velocity", velocity_override__hold=0.5)
    live.start("override", sys.executable, find_executable("mr_robot", "velocity_override"))
    live.start("publisher", find_executable("robot_state_publisher", "robot_state_publisher"))
    driven = live.run(sys.executable, "-c", DRIVE)
    assert driven.stdout.strip() == "[(0.5, 0.0), (0.0, 1.0), (0.0, 0.0)] (0.5, 0.0)", driven.stdout + driven.stderr
    static = live.run("rostopic", "echo", "-n1", "/tf_static").stdout
    for words in ('child_frame_id: "base_link"', 'child_frame_id: "base_laser_link"', "x: 0.1", "z: 0.25"):
        assert words in static, static
