/** The state of the page: all of it fits into a link. */

import type { Question } from "./engine/engine";

export type Tab = "plan" | "search" | "drive" | "compare" | "papers";
export const TABS: readonly Tab[] = ["plan", "search", "drive", "compare", "papers"];
/** The things that are compared. */
export type Compared = "planners" | "stacks";
export type Pair = [number, number];
export type Disc = { at: Pair; radius_m: number };
/** Somebody who walks to and fro between two places. */
export type Walker = { from: Pair; to: Pair };
/** A cell that was drawn: column, row, and 1 for a wall or 0 for free ground. */
export type Drawn = [number, number, 0 | 1];

export const WALKER_RADIUS_M = 0.25;
export const WALKER_SPEED_MPS = 0.6;

export interface State {
    tab: Tab;
    /** A bundled map or scene, a map of a claim, or the name of an own one. */
    map: string;
    /** The text of the scene that is open; `null` for one that is drawn. */
    scene: string | null;
    /** A stack for all robots of that scene; empty: those that it names. */
    sceneStack: string;
    planner: string;
    /** Planners whose searches are shown beside that of the first one; empty ones are left out. */
    beside: string[];
    /** Show the shortest line in any direction. */
    shortest: boolean;
    /** Show the velocities that were tried. */
    fan: boolean;
    smoother: string;
    radius_m: number;
    robot: string;
    stack: string;
    seed: number;
    /** Disturbances: the delay of the motors, and the noise of the lidar (a standard deviation). */
    delay_s: number;
    noise_m: number;
    start: Pair;
    goal: Pair;
    discs: Disc[];
    walkers: Walker[];
    drawn: Drawn[];
    compared: Compared;
    planners: string[];
    smoothers: string[];
    queries: number;
    stacks: string[];
    runs: number;
    claim: string;
    /** Show the paper's own map, where it was reconstructed. */
    paperScene: boolean;
    claimSeed: number;
    claimMaps: number;
}

export const LIMITS = { queries: 1000, runs: 100, seed: 1e9, claimMaps: 200, drawn: 100_000 };

export const initial = (): State => ({
    tab: "plan",
    map: "house",
    scene: null,
    sceneStack: "",
    planner: "jps",
    beside: [],
    shortest: true,
    fan: false,
    smoother: "taut",
    radius_m: 0.2,
    robot: "small",
    stack: "keyway",
    seed: 0,
    delay_s: 0,
    noise_m: 0,
    start: [-8.175, -2.825],
    goal: [8.725, 0.875],
    discs: [{ at: [0.3, -0.275], radius_m: 0.15 }],
    walkers: [],
    drawn: [],
    compared: "stacks",
    planners: ["jps", "theta-star"],
    smoothers: ["none", "taut"],
    queries: 20,
    stacks: ["keyway", "s0-key-point", "astar-follow"],
    runs: 1,
    claim: "S0-1",
    paperScene: true,
    claimSeed: 1,
    claimMaps: 20,
});

/** A link cannot hold more of a kind. */
const MOST = 1000;
const FARTHEST_M = 1e5;

type Check<T> = (value: unknown) => value is T;

const isText: Check<string> = (value): value is string =>
    typeof value === "string" && value.length < 200;
const isBetween =
    (low: number, high: number): Check<number> =>
    (value): value is number =>
        typeof value === "number" && value >= low && value <= high;
const isWhole =
    (high: number): Check<number> =>
    (value): value is number =>
        Number.isInteger(value) && isBetween(0, high)(value);
const isPair: Check<Pair> = (value): value is Pair =>
    Array.isArray(value) && value.length === 2 && value.every(isBetween(-FARTHEST_M, FARTHEST_M));
const isRecord = (value: unknown): value is Record<string, unknown> =>
    typeof value === "object" && value !== null;
const isDisc: Check<Disc> = (value): value is Disc =>
    isRecord(value) && isPair(value["at"]) && isBetween(0.001, 100)(value["radius_m"]);
const isWalker: Check<Walker> = (value): value is Walker =>
    isRecord(value) && isPair(value["from"]) && isPair(value["to"]);
const isDrawn: Check<Drawn> = (value): value is Drawn =>
    Array.isArray(value) &&
    value.length === 3 &&
    value.slice(0, 2).every(isWhole(1e6)) &&
    isWhole(1)(value[2]);
const isFlag: Check<boolean> = (value): value is boolean => typeof value === "boolean";
/** Longer scenes are not in a link. */
const MOST_SCENE = 100_000;
const isScene: Check<string | null> = (value): value is string | null =>
    value === null || (typeof value === "string" && value.length < MOST_SCENE);
const isList =
    <T>(is: Check<T>, most = MOST): Check<T[]> =>
    (value): value is T[] =>
        Array.isArray(value) && value.length <= most && value.every(is);

const CHECKS: { [Field in keyof State]: Check<State[Field]> } = {
    tab: (value): value is Tab => TABS.some((tab) => tab === value),
    map: isText,
    scene: isScene,
    sceneStack: isText,
    planner: isText,
    beside: (value): value is string[] => isList(isText)(value) && value.length <= 3,
    shortest: isFlag,
    fan: isFlag,
    smoother: isText,
    radius_m: isBetween(0, 1000),
    robot: isText,
    stack: isText,
    seed: isWhole(Number.MAX_SAFE_INTEGER),
    delay_s: isBetween(0, 1),
    noise_m: isBetween(0, 1),
    start: isPair,
    goal: isPair,
    discs: isList(isDisc),
    walkers: isList(isWalker),
    drawn: isList(isDrawn, LIMITS.drawn),
    compared: (value): value is Compared => value === "planners" || value === "stacks",
    planners: isList(isText),
    smoothers: isList(isText),
    queries: isWhole(LIMITS.queries),
    stacks: isList(isText),
    runs: isWhole(LIMITS.runs),
    claim: isText,
    paperScene: isFlag,
    claimSeed: isWhole(LIMITS.seed),
    claimMaps: isWhole(LIMITS.claimMaps),
};

/** The fields that can be used; those that cannot are as at the beginning. */
export function checked(given: unknown): State {
    const state = initial();
    if (!isRecord(given)) return state;
    const take = <Field extends keyof State>(field: Field) => {
        const value = Object.hasOwn(given, field) ? given[field] : undefined;
        if (CHECKS[field](value)) state[field] = value as State[Field];
    };
    for (const field of Object.keys(CHECKS) as (keyof State)[]) take(field);
    return state;
}

/** A drive, as a question for the library. */
export function driveQuestion(state: State, map: string): Question {
    const { scene, sceneStack, seed, drawn } = state;
    if (scene === null) return { ask: "drive", scene: sceneFile(state, map), name: map };
    const stack = sceneStack === "" ? null : sceneStack;
    return { ask: "drive", scene, name: map, seed, stack, on_open_map: drawn.length > 0 };
}

/** The scene of a drive, as a file for `keyway navigate --scene`. */
export function sceneFile(state: State, map: string): string {
    const pair = ([x, y]: Pair) => `[${x}, ${y}]`;
    const lines = [
        "version = 2",
        `map = ${JSON.stringify(map)}`,
        `robot = ${JSON.stringify(state.robot)}`,
        `stack = ${JSON.stringify(state.stack)}`,
        `seed = ${state.seed}`,
        `start = ${pair(state.start)}`,
        `goal = ${pair(state.goal)}`,
    ];
    if (state.delay_s > 0 || state.noise_m > 0) {
        lines.push("", "[disturbances]", `actuation = { delay_s = ${state.delay_s} }`);
        lines.push(`sensor = { range_m = ${state.noise_m} }`);
    }
    for (const { at, radius_m } of state.discs) {
        lines.push("", "[[unknown]]", `position = ${pair(at)}`, `radius_m = ${radius_m}`);
    }
    for (const { from, to } of state.walkers) {
        lines.push("", "[[moving]]", `radius_m = ${WALKER_RADIUS_M}`);
        lines.push(`way_points = [${pair(from)}, ${pair(to)}]`);
        lines.push(`speed_mps = ${WALKER_SPEED_MPS}`, "to_and_fro = true");
    }
    return lines.join("\n") + "\n";
}
