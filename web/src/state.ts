/** What is shown: all of it fits into a link. */

export type Tab = "plan" | "search" | "drive";
export type Pair = [number, number];
export type Disc = { at: Pair; radius_m: number };
/** Somebody who walks to and fro between two places. */
export type Walker = { from: Pair; to: Pair };

export const WALKER_RADIUS_M = 0.25;
export const WALKER_SPEED_MPS = 0.6;

export interface State {
    tab: Tab;
    /** A bundled map; own maps are not in links. */
    map: string;
    planner: string;
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
    /** Cells that were drawn: free ones and walls. */
    free: Pair[];
    walls: Pair[];
}

export const INITIAL: State = {
    tab: "plan",
    map: "house",
    planner: "jps",
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
    free: [],
    walls: [],
};

async function through(bytes: Uint8Array, stream: TransformStream): Promise<Uint8Array> {
    const body = new Blob([bytes as BlobPart]).stream().pipeThrough(stream);
    return new Uint8Array(await new Response(body).arrayBuffer());
}

/** The state as the fragment of an address. */
export async function toFragment(state: State): Promise<string> {
    const text = new TextEncoder().encode(JSON.stringify(state));
    const packed = await through(text, new CompressionStream("deflate-raw"));
    const letters = btoa(String.fromCharCode(...packed));
    return letters.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** The state of a fragment; the initial one where it is damaged or there is none. */
export async function fromFragment(fragment: string): Promise<State> {
    try {
        const letters = atob(fragment.replaceAll("-", "+").replaceAll("_", "/"));
        const packed = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
        const text = await through(packed, new DecompressionStream("deflate-raw"));
        return { ...INITIAL, ...(JSON.parse(new TextDecoder().decode(text)) as Partial<State>) };
    } catch {
        return structuredClone(INITIAL);
    }
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
