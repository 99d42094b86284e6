/** Maps and scenes that come with the page. */

import houseYaml from "../../crates/keyway-cli/scenes/small_house.yaml?url";
import housePng from "../../crates/keyway-cli/scenes/small_house.png?url";
import roomsMap from "../../crates/keyway-cli/scenes/rooms.map?url";
import type { Parts } from "./engine/message";
import { initial, type Pair } from "./state";

interface Bundled {
    /** Names and addresses; the first one is the map. */
    files: [string, string][];
    start: Pair;
    goal: Pair;
}

const { start, goal } = initial();

const BUNDLED = new Map<string, Bundled>([
    [
        "house",
        {
            files: [
                ["small_house.yaml", houseYaml],
                ["small_house.png", housePng],
            ],
            start,
            goal,
        },
    ],
    ["rooms", { files: [["rooms.map", roomsMap]], start: [1.5, 1.5], goal: [30.5, 30.5] }],
]);

/** Addresses of the files of scenes, by their paths. */
const FILES: Record<string, string> = import.meta.glob(
    // One is a robot, and another one is driven by that robot.
    [
        "../../scenes/{fleet,complaints,s1,you2021,zhuyin2024}/*",
        "!**/long.toml",
        "!**/wrong_heading.toml",
    ],
    { query: "?url", import: "default", eager: true },
);

/** The folder and the name of a path. */
const split = (path: string) => path.split("/").slice(-2) as [string, string];

/** Names such as `fleet/bay`, by folder. */
export const SCENES: Map<string, string[]> = new Map();
for (const path of Object.keys(FILES)) {
    const [folder, name] = split(path);
    if (!name.endsWith(".toml")) continue;
    SCENES.set(folder, [...(SCENES.get(folder) ?? []), name.replace(".toml", "")]);
}

export const isBundled = (map: string) => BUNDLED.has(map);

/** True if there is a scene such as `fleet/bay`. */
export const isScene = (scene: string) =>
    [...SCENES].some(([folder, names]) => names.some((name) => scene === `${folder}/${name}`));

/** The files of a map, the name of the first one, and a start and a goal. */
export async function load(
    map: string,
): Promise<{ name: string; parts: Parts; ends: [Pair, Pair] }> {
    const bundled = BUNDLED.get(map);
    if (!bundled) throw new Error(`there is no map ${map}`);
    return {
        name: bundled.files[0]![0],
        parts: await loaded(bundled.files),
        ends: [[...bundled.start], [...bundled.goal]],
    };
}

/** All files of bundled maps: scenes name some of them. */
export const bundledFiles = () => loaded([...BUNDLED.values()].flatMap(({ files }) => files));

/** The files of a scene such as `fleet/bay`: its own, all maps of its folder, and all others. */
export async function loadScene(scene: string): Promise<{ name: string; parts: Parts }> {
    const [own, wanted] = split(scene);
    const isNeeded = ([folder, name]: [string, string]) =>
        folder === own && (name === `${wanted}.toml` || !name.endsWith(".toml"));
    const needed = Object.entries(FILES).filter(([path]) => isNeeded(split(path)));
    const files = needed.map(([path, address]): [string, string] => [split(path)[1], address]);
    const parts = { ...(await bundledFiles()), ...(await loaded(files)) };
    return { name: `${wanted}.toml`, parts };
}

async function loaded(files: [string, string][]): Promise<Parts> {
    const read = files.map(async ([name, address]): Promise<[string, Uint8Array]> => {
        const content = await (await fetch(address)).arrayBuffer();
        return [name, new Uint8Array(content)];
    });
    return Object.fromEntries(await Promise.all(read));
}
