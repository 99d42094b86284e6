"""When the network between robot and node loses packets and lets others wait: goals are reached, and who is not told enough stands."""

import time

from action_msgs.msg import GoalStatus
from air import Air
from peer import Keyway, ToAndFro, begin, leave, wait
from robot import Robot

MAX_POSE_AGE_S, CYCLE_S = 0.2, 0.1


class Lossy(ToAndFro):
    def __init__(self, air: Air) -> None:
        super().__init__(Robot(), Keyway(start=air.start))
        self.air = air
        self.robot.watchdog_s = 0.5
        air.set(lost=0.05, delay_s=0.02, jitter_s=0.02)

    def a_goal_is_reached(self) -> None:
        for _ in range(4):
            began, before = time.monotonic(), len(self.robot.commanded_at)
            self.arrives(*self.set_out())
            times = self.robot.commanded_at[before:]
            longest_s = max(after - earlier for earlier, after in zip(times, times[1:]))
            print(f"    in {time.monotonic() - began:.1f} s, longest time between two commands {longest_s:.2f} s", flush=True)

    def a_lost_robot_stands(self) -> None:
        goal, place = self.set_out()
        self.robot.is_lost = True
        began = time.monotonic()
        assert wait(lambda: self.robot.command == (0.0, 0.0), 3), "it drives without poses"
        # What was under way, and what was lost and sent again.
        stopped_s = time.monotonic() - began
        assert stopped_s < MAX_POSE_AGE_S + CYCLE_S + 0.5, stopped_s
        assert wait(self.robot.stands, 3)
        self.robot.is_lost = False
        self.arrives(goal, place)

    def a_goal_is_given_up(self) -> None:
        goal, _ = self.set_out()
        assert goal.cancel() == 0 and goal.end().status == GoalStatus.STATUS_CANCELED
        assert wait(self.robot.stands, 3)

    def a_network_that_is_cut_for_a_while(self) -> None:
        goal, place = self.set_out()
        self.air.set(lost=1.0)
        assert wait(self.robot.stands, 3), "the base has a watchdog"
        time.sleep(1.0)
        assert self.robot.stands()
        self.air.set(lost=0.05, delay_s=0.02, jitter_s=0.02)
        self.arrives(goal, place)


if __name__ == "__main__":
    # The interface must be there before anybody looks for interfaces.
    between = Air()
    begin()
    lossy = Lossy(between)
    leave(lossy.run(), lossy.keyway)
