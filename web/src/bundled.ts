/** Maps that come with the page. */

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

export const isBundled = (map: string) => BUNDLED.has(map);

/** The files of a map, the name of the first one, and a start and a goal. */
export async function load(
    map: string,
): Promise<{ name: string; parts: Parts; ends: [Pair, Pair] }> {
    const bundled = BUNDLED.get(map);
    if (!bundled) throw new Error(`there is no map ${map}`);
    const files = bundled.files.map(async ([name, address]): Promise<[string, Uint8Array]> => {
        const content = await (await fetch(address)).arrayBuffer();
        return [name, new Uint8Array(content)];
    });
    const parts = Object.fromEntries(await Promise.all(files));
    return {
        name: bundled.files[0]![0],
        parts,
        ends: [[...bundled.start], [...bundled.goal]],
    };
}
