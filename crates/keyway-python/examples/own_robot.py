"""Keyway in your own robot: no simulator, no files. Replace `Hardware` with your drivers."""

import math

import numpy as np

import keyway


class Hardware:
    """Stands for your odometry, lidar and motors: here each command is obeyed at once, and nothing is met."""

    def __init__(self, pose: tuple[float, float, float]) -> None:
        self.pose, self.velocity, self.stamp = pose, (0.0, 0.0), 0.0

    def drive(self, v: float, omega: float, cycle: float) -> None:
        x, y, theta = self.pose
        middle = theta + 0.5 * omega * cycle
        self.pose = (x + v * cycle * math.cos(middle), y + v * cycle * math.sin(middle), theta + omega * cycle)
        self.velocity, self.stamp = (v, omega), self.stamp + cycle


def cycle(navigator: keyway.Navigator, hardware: Hardware) -> bool:
    """One control cycle; true once the robot has arrived."""
    navigator.observe(hardware.stamp, hardware.pose, hardware.velocity, navigator.clear_scan)
    step = navigator.step()
    if step.why:
        print(f"{hardware.stamp:.1f} s: {step.why}")
    hardware.drive(step.v, step.omega, navigator.cycle)
    return step.status == "arrived"


def main() -> None:
    grid = keyway.Map.from_array(np.zeros((70, 120), dtype=bool), resolution=0.1)
    navigator, hardware = keyway.Navigator(grid, robot="small"), Hardware((2.5, 3.5, 0.0))
    navigator.relocate(hardware.pose)
    navigator.set_goal((9.5, 3.5))
    for _ in range(50):
        cycle(navigator, hardware)
    # A wall appears on the map, and the robot goes around it; then it is wanted elsewhere, slowly.
    navigator.edit_map(keyway.Map.from_array(np.ones((40, 2), dtype=bool), resolution=0.1, origin=(7, 2)))
    for _ in range(30):
        cycle(navigator, hardware)
    navigator.set_goals([(5.5, 1.0)], (1.5, 5.5))
    navigator.set_speed_limit(0.4)
    while not cycle(navigator, hardware):
        pass
    print(f"arrived after {hardware.stamp:.1f} s at ({hardware.pose[0]:.2f}, {hardware.pose[1]:.2f})")
    navigator.spin(3.0, 30.0)
    while not cycle(navigator, hardware):
        pass
    print(f"turned to {hardware.pose[2]:.2f} rad")


if __name__ == "__main__":
    main()
