"""Whole agents in a small scene: they drive, see discs and walls with their lasers, draw maps and talk."""

import math

import numpy as np
from meeting_scene import Scene
from team import team_of

from map_merger.synthetic.scanning import GridDrawer, info_around
from map_merger.transform import displacement, rotation_between

STEP_S = 0.2
DRAWING_STEPS, MAP_STEPS = 3, 10
AROUND = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 3.0], [-3.0, 0.0]])


class AgentScene:
    """The robots of a scene with an agent each. `lost(sender, receiver, payload)` as in Team."""

    def __init__(self, scene: Scene, lost=None):
        self.scene = scene
        self.team = team_of(*(robot.name for robot in scene.robots), seconds_send_timer=3, seconds_pub_timer=3)
        if lost is not None:
            self.team.lost = lost
        self.time, self.steps = 0.0, 0
        self.drawers = {
            robot.name: GridDrawer(info_around(np.zeros((1, 2)), 12.0, 0.05, scene.random.uniform(-0.02, 0.02, 2)))
            for robot in scene.robots
        }

    def step(self):
        """0.2 s go by."""
        self.time, self.steps = self.time + STEP_S, self.steps + 1
        self.scene.time = self.time
        self.team.now += STEP_S
        for robot in self.scene.robots:
            agent = self.team.agents[robot.name]
            pose = self.scene.frame(robot).inverse().compose(robot.way(self.time))
            scan = self.scene.scan(robot)
            agent.on_local_pose(pose, self.team.now)
            if agent.wants_scans:
                agent.on_scan(scan, pose, self.team.now)
            if self.steps % DRAWING_STEPS == 1:
                angles = scan.angle_min + scan.angle_increment * np.arange(scan.ranges.size)
                ranges = np.nan_to_num(scan.ranges, nan=robot.farthest)
                self.drawers[robot.name].add(pose, angles, np.where(np.isnan(scan.ranges), 0.0, ranges), robot.farthest)
            if self.steps % MAP_STEPS == 1:
                agent.on_local_map(self.drawers[robot.name].grid(), self.team.now)
            agent.tick(self.team.now)
            self.team.settle(robot.name)

    def run(self, until):
        """Until that time (s) of the scene. Whoever is placed on the way is placed right, or this fails."""
        while self.time < until - 1e-9:
            self.step()
            self.assert_right()
        return self

    def until_placed(self, latest):
        """Runs until every robot has placed every other; the time, or infinity if that takes longer than `latest`."""
        while self.time < latest:
            self.step()
            self.assert_right()
            if all(len(agent.view.transforms()) == len(self.team.agents) - 1 for agent in self.team.agents.values()):
                return self.time
        return math.inf

    def assert_right(self, shift=0.3, turn=3.0):
        """All transforms that are believed are right."""
        for own, agent in self.team.agents.items():
            for robot, transform in agent.view.transforms().items():
                truth = self.scene.truth(robot, own)
                assert displacement(truth, transform, AROUND).max() < shift, (self.time, own, robot, transform, truth)
                assert rotation_between(transform, truth) < math.radians(turn), (self.time, own, robot)

    def why(self, own, robot):
        """What the status says of a robot."""
        status = self.team.agents[own].view.status(self.team.now)
        return next(each.why for each in status.robots if each.robot == robot)
