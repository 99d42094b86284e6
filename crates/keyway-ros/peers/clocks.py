"""When clocks jump: that of a simulation, and that of the robot's drivers beside that of the node's machine."""

import subprocess
import sys
import time

from peer import Keyway, ToAndFro, begin, leave, wait
from robot import Robot


class Clocks(ToAndFro):
    def __init__(self, has_clock: bool) -> None:
        super().__init__(Robot(has_clock=has_clock), Keyway(f"use_sim_time:={str(has_clock).lower()}"))


class Simulated(Clocks):
    """The clock of a simulation, of which everybody is told."""

    def __init__(self) -> None:
        super().__init__(has_clock=True)

    def what_jumps_ahead_is_driven_on_by(self) -> None:
        goal, place = self.set_out()
        self.robot.clock_ahead_s += 7.0
        self.arrives(goal, place)

    def what_jumps_back_is_driven_on_by(self) -> None:
        goal, place = self.set_out()
        self.robot.clock_ahead_s -= 7.0
        self.arrives(goal, place)


class Drivers(Clocks):
    """The clock of the drivers, which have a computer of their own; the node has that of its machine."""

    def __init__(self) -> None:
        super().__init__(has_clock=False)

    def stands_while_it_is(self, ahead_s: float) -> None:
        goal, place = self.set_out()
        self.robot.clock_ahead_s = ahead_s
        assert wait(self.robot.stands, 3), "it drives by another clock"
        time.sleep(1.0)
        assert self.robot.stands() and self.robot.command == (0.0, 0.0)
        self.robot.clock_ahead_s = 0.0
        self.arrives(goal, place)

    def what_is_ahead_is_not_driven_by(self) -> None:
        self.stands_while_it_is(0.5)

    def what_is_behind_is_not_driven_by(self) -> None:
        self.stands_while_it_is(-0.5)

    def what_is_far_ahead_is_not_driven_by(self) -> None:
        self.stands_while_it_is(100.0)


KINDS = {"drivers": Drivers, "simulated": Simulated}

if __name__ == "__main__":
    if len(sys.argv) == 1:
        # Each with a robot of its own.
        sys.exit(sum(subprocess.run([sys.executable, __file__, kind]).returncode for kind in KINDS))
    begin()
    clocks = KINDS[sys.argv[1]]()
    print(clocks.__doc__, flush=True)
    leave(clocks.run(), clocks.keyway)
