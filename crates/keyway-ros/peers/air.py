"""A network like a wireless one, between this program and another on the same machine: packets are lost, and come late and out
of their order. The other program is in a network namespace of its own; between the two, every frame goes through here."""

import fcntl
import heapq
import os
import random
import select
import socket
import struct
import subprocess
import sys
import time

NEAR, FAR = "10.45.0.1", "10.45.0.2"


def open_end(address: str) -> int:
    """One end of a cable, in the network namespace of this program."""
    set_interface, ethernet_without_header = 0x400454CA, 0x0002 | 0x1000
    end = os.open("/dev/net/tun", os.O_RDWR)
    fcntl.ioctl(end, set_interface, struct.pack("16sH14x", b"air", ethernet_without_header))
    for command in ("link set lo up", f"addr add {address}/24 dev air", "link set air up", "route replace 224.0.0.0/4 dev air"):
        subprocess.run(["ip", *command.split()], check=True)
    return end


class Air:
    """The network. `set` changes what becomes of packets; at first nothing does."""

    def __init__(self) -> None:
        self.near = open_end(NEAR)
        self.forwarder = None

    def start(self, command: list[str]) -> subprocess.Popen:
        """Starts a program at the far end; it is the process that is returned."""
        if self.forwarder is not None:
            self.forwarder.kill()
        ours, theirs = socket.socketpair()
        with ours, theirs:
            in_its_own = ["unshare", "--net", sys.executable, __file__, "far", str(theirs.fileno()), *command]
            process = subprocess.Popen(in_its_own, pass_fds=[theirs.fileno()])
            _, (far, *_), _, _ = socket.recv_fds(ours, 1, 1)
        ends = [self.near, far]
        forward = [sys.executable, __file__, "forward", *map(str, ends)]
        self.forwarder = subprocess.Popen(forward, pass_fds=ends, stdin=subprocess.PIPE)
        os.close(far)
        return process

    def set(self, lost: float, delay_s: float = 0.0, jitter_s: float = 0.0) -> None:
        """Loses this share of all packets; the others come after a delay, more or less the jitter."""
        self.forwarder.stdin.write(struct.pack("3d", lost, delay_s, jitter_s))
        self.forwarder.stdin.flush()


def begin_at_the_far_end(channel: str, *command: str) -> None:
    end = open_end(FAR)
    with socket.socket(fileno=int(channel)) as given:
        socket.send_fds(given, [b"1"], [end])
    # The interface lives as long as the forwarder has its end.
    os.close(end)
    os.execvp(command[0], command)


def forward(near: str, far: str) -> None:
    other = {int(near): int(far), int(far): int(near)}
    chance = random.Random(45)
    lost, delay_s, jitter_s = 0.0, 0.0, 0.0
    later: list[tuple[float, int, int, bytes]] = []
    count = 0
    while True:
        now = time.monotonic()
        while later and later[0][0] <= now:
            _, _, end, frame = heapq.heappop(later)
            try:
                os.write(end, frame)
            except OSError:
                # The program at that end has gone.
                pass
        longest_s = max(later[0][0] - now, 0.0) if later else None
        for end in select.select([sys.stdin, *other], [], [], longest_s)[0]:
            if end is sys.stdin:
                told = os.read(sys.stdin.fileno(), 24)
                if not told:
                    return
                lost, delay_s, jitter_s = struct.unpack("3d", told)
                continue
            frame = os.read(end, 2048)
            if chance.random() >= lost:
                count += 1
                late_s = max(delay_s + chance.uniform(-jitter_s, jitter_s), 0.0)
                heapq.heappush(later, (time.monotonic() + late_s, count, other[end], frame))


if __name__ == "__main__":
    {"far": begin_at_the_far_end, "forward": forward}[sys.argv[1]](*sys.argv[2:])
