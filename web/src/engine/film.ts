/** A drive as the library tells it, taken apart. */

import type { Pair } from "../state";
import { integers, singles, type Parts } from "./message";
import type { CycleReport, Driven } from "./types";

/** Points of where a velocity would lead, and what became of it (see crates/keyway-web). */
export interface Candidate {
    fate: "admissible" | "chosen" | "second" | "touching" | "refused";
    points: Pair[];
}

const FATES = ["admissible", "chosen", "second", "touching", "refused"] as const;
const FAN_NUMBERS = 14;

/** One robot of a drive. */
export class Film {
    private readonly hits: Pair[][];
    private readonly newCells: Pair[][];
    private readonly movers: Float32Array;
    private readonly fans: Float32Array;
    private readonly fanCounts: Int32Array;
    /** Of each cycle: where its fan begins. */
    private readonly fanStarts: number[] = [];
    private readonly refusals: Map<number, string>;

    constructor(
        private readonly driven: Driven,
        parts: Parts,
        private readonly robot: number,
    ) {
        this.hits = lists(integers(parts[`hits ${robot}`]), singles(parts[`hits ${robot}`]));
        const sensed = integers(parts[`sensed ${robot}`]);
        this.newCells = lists(sensed, sensed);
        this.movers = singles(parts[`movers ${robot}`]);
        this.fans = singles(parts[`fans ${robot}`]);
        this.fanCounts = integers(parts[`fans ${robot}`]);
        for (let at = 0; at < this.fanCounts.length;) {
            this.fanStarts.push(at);
            at += 1 + FAN_NUMBERS * this.fanCounts[at]!;
        }
        this.refusals = new Map(driven.refusals[robot] ?? []);
    }

    get cycles(): CycleReport[] {
        return this.driven.cycles[this.robot] ?? [];
    }

    get outline(): { radius_m: number | null; vertices: Pair[] } {
        return this.driven.outlines[this.robot]!;
    }

    /** A cycle, or the last one of a robot whose run has ended. */
    cycle(shown: number): CycleReport | undefined {
        return this.cycles[this.within(shown)];
    }

    private within(shown: number): number {
        return Math.min(shown, this.cycles.length - 1);
    }

    driveUpTo(shown: number): Pair[] {
        return this.cycles.slice(0, shown + 1).map(({ pose }): Pair => [pose[0], pose[1]]);
    }

    route(shown: number): Pair[] {
        const cycle = this.cycle(shown)?.cycle ?? 0;
        const routes = this.driven.routes[this.robot] ?? [];
        return routes.filter(([from]) => from <= cycle).at(-1)?.[1] ?? [];
    }

    hitsAt(shown: number): Pair[] {
        return this.hits[this.within(shown)] ?? [];
    }

    sensedUpTo(shown: number): Pair[] {
        return this.newCells.slice(0, shown + 1).flat();
    }

    moversAt(shown: number): { at: Pair; radius_m: number }[] {
        const radii = this.driven.mover_radii_m;
        return radii.map((radius_m, i) => {
            const from = 2 * (this.within(shown) * radii.length + i);
            return { at: [this.movers[from]!, this.movers[from + 1]!], radius_m };
        });
    }

    /** The reason why the stop rule refused the command; nothing where it let it pass. */
    refusal(shown: number): string | undefined {
        return this.refusals.get(this.cycle(shown)?.cycle ?? -1);
    }

    fan(shown: number): Candidate[] {
        const start = this.fanStarts[this.within(shown)];
        if (start === undefined) return [];
        return Array.from({ length: this.fanCounts[start]! }, (_, i) => {
            const from = start + 1 + FAN_NUMBERS * i;
            const points: Pair[] = [];
            for (let at = from + 2; at < from + FAN_NUMBERS; at += 2) {
                points.push([this.fans[at]!, this.fans[at + 1]!]);
            }
            return { fate: FATES[this.fans[from]!] ?? "refused", points };
        });
    }
}

/** For each cycle a count, and as many pairs. */
function lists(counts: Int32Array, numbers: Int32Array | Float32Array): Pair[][] {
    const all: Pair[][] = [];
    for (let at = 0; at < counts.length;) {
        const count = counts[at++]!;
        all.push(
            Array.from({ length: count }, (_, i) => [
                numbers[at + 2 * i]!,
                numbers[at + 2 * i + 1]!,
            ]),
        );
        at += 2 * count;
    }
    return all;
}
