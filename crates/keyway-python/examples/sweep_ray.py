"""Drives scenes x stacks x seeds on a cluster of Ray, and leaves the files that `keyway batch` leaves on one machine.

    python sweep_ray.py scenes/ --stacks keyway,s0-key-point --seeds 3 --parts 8 --out results

Ray divides the parts among its machines; Keyway makes each of them and puts them together. Where a part is made makes no
difference to a byte of the results. Each part comes back as the bytes of its folder, so the machines need no common disk but
for the scenes. Needs `pip install keyway-nav ray`.
"""

import argparse
import io
import pathlib
import tarfile
import tempfile

import ray

import keyway


@ray.remote(num_cpus=1)
def make_part(scenes: list[str], stacks: list[str] | None, seeds: int, part: int, parts: int) -> bytes:
    """One part of the batch, as a tar archive of its folder."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "part"
        keyway.batch(scenes, out, stacks=stacks, seeds=seeds, jobs=1, shard=(part, parts))
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w") as tar:
            tar.add(out, arcname=f"part-{part}")
        return archive.getvalue()


def sweep(scenes: list[str], stacks: list[str] | None, seeds: int, parts: int, out: pathlib.Path) -> dict[str, object]:
    """All runs; gives the report of the whole batch."""
    scenes = [str(pathlib.Path(scene).resolve()) for scene in scenes]
    pending = [make_part.remote(scenes, stacks, seeds, part, parts) for part in range(1, parts + 1)]
    with tempfile.TemporaryDirectory() as folder:
        while pending:
            done, pending = ray.wait(pending)
            for archive in ray.get(done):
                with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
                    tar.extractall(folder, filter="data")
            print(f"{parts - len(pending)} of {parts} parts", flush=True)
        folders = [pathlib.Path(folder) / f"part-{part}" for part in range(1, parts + 1)]
        return keyway.merge(folders, out)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", help="scene files, and folders of them")
    parser.add_argument("--stacks", help="names or files, with commas; `all`")
    parser.add_argument("--seeds", type=int, default=1, help="how many seeds each scene is driven with")
    parser.add_argument("--parts", type=int, default=8, help="into how many parts Ray may divide the work")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for the results")
    parser.add_argument("--address", help="of a running cluster; without it, one is started on this machine")
    parser.add_argument("--workers", type=int, help="processes on this machine, where one is started")
    args = parser.parse_args()
    ray.init(address=args.address, num_cpus=args.workers, log_to_driver=False, include_dashboard=False)
    stacks = args.stacks.split(",") if args.stacks else None
    report = sweep(args.scenes, stacks, args.seeds, args.parts, args.out)
    print(f"{report['runs']} runs in {args.out}")


if __name__ == "__main__":
    main()
