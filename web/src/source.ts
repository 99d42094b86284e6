/** Where the map comes from: bundled maps and scenes, own files, and claims of papers. */

import { isBundled, isScene, load, loadScene } from "./bundled";
import type { Engine } from "./engine/engine";
import type { Parts } from "./engine/message";
import type { ClaimMap, MapFacts, SceneFacts } from "./engine/types";
import type { Ground } from "./ground";
import type { Pair, State } from "./state";
import { texts } from "./texts";

/** Prefixes of the names of maps in a link. */
const SCENE = "scene ";
const CLAIM = "claim ";

export class Source {
    /** The scene that is open; `null` for one that is drawn. */
    scene: SceneFacts | null = null;
    /** Texts of the scenes of a table, by their names. */
    private readonly own = new Map<string, string>();
    /** The files of that scene, for another seed. */
    private sceneFiles: { name: string; parts: Parts } | null = null;

    constructor(
        private readonly engine: Engine,
        private readonly ground: Ground,
        private readonly state: State,
        private readonly say: (text: string) => void,
    ) {}

    /** Opens what a link names, or the house where that is not to be had. */
    async restore(): Promise<void> {
        const { map, drawn, scene, seed } = this.state;
        try {
            if (isBundled(map)) await this.openBundled(map);
            else if (map.startsWith(CLAIM)) await this.openClaim(map);
            else if (isScene(map.slice(SCENE.length))) await this.open(map);
            else if (scene !== null) {
                const parts = { [map]: new TextEncoder().encode(scene) };
                await this.openScene(map, parts, seed);
            } else throw new Error(map);
            this.state.seed = seed;
            this.ground.draw(this.engine, drawn);
        } catch {
            await this.open("house");
            this.say(texts.notInLink(map));
        }
    }

    /** True for what can be opened again. */
    isKnown(map: string): boolean {
        return isBundled(map) || isScene(map.slice(SCENE.length)) || this.own.has(map);
    }

    /** Opens a bundled map or scene anew, or one of a table. */
    async open(map: string): Promise<void> {
        const text = this.own.get(map);
        if (text !== undefined) {
            await this.openScene(map, { [map]: new TextEncoder().encode(text) }, null);
            return;
        }
        if (map.startsWith(SCENE)) {
            const { name, parts } = await loadScene(map.slice(SCENE.length));
            const { seed } = this.state;
            await this.openScene(name, parts, this.state.map === map ? seed : null);
            this.state.map = map;
            return;
        }
        const [start, goal] = await this.openBundled(map);
        this.forget();
        Object.assign(this.state, { start, goal });
    }

    private async openBundled(map: string): Promise<[Pair, Pair]> {
        const { name, parts, ends } = await load(map);
        const facts = await this.ground.open(this.engine, name, parts);
        this.leaveScene();
        this.tell(facts);
        this.state.map = map;
        return ends;
    }

    /**
     * Own files: a map, a scene with its map, or a table of scenes. The names of what was opened,
     * and of what can be opened from now on.
     */
    async openOwn(files: File[]): Promise<string[]> {
        const named = (pattern: RegExp) => files.find(({ name }) => pattern.test(name));
        const first = named(/\.(toml|csv)$/i) ?? named(/\.(ya?ml|map)$/i) ?? files[0];
        if (!first) return [];
        const read = files.map(async (file): Promise<[string, Uint8Array]> => [
            file.name,
            new Uint8Array(await file.arrayBuffer()),
        ]);
        const parts = Object.fromEntries(await Promise.all(read));
        if (/\.csv$/i.test(first.name)) return this.openTable(first.name, parts);
        if (/\.toml$/i.test(first.name)) await this.openScene(first.name, parts, null);
        else {
            this.tell(await this.ground.open(this.engine, first.name, parts));
            this.leaveScene();
            this.forget();
            const { radius_m } = this.state;
            this.state.start = this.ground.freeNear(0.25, radius_m);
            this.state.goal = this.ground.freeNear(0.75, radius_m);
        }
        this.state.map = first.name;
        return [first.name];
    }

    private async openTable(name: string, parts: Parts): Promise<string[]> {
        const question = { ask: "barn_scenes", name };
        const { head } = await this.engine.ask<{ name: string; text: string }[]>(question, parts);
        for (const scene of head) this.own.set(scene.name, scene.text);
        const names = head.map((scene) => scene.name);
        await this.open(names[0]!);
        return names;
    }

    /** A map that a part of the page has opened. */
    show(facts: MapFacts, cells: Uint8Array, name: string): void {
        this.ground.show(facts, cells);
        this.leaveScene();
        this.forget();
        this.state.map = name;
    }

    /** The scene has another world with another seed. */
    async reseed(): Promise<void> {
        const { scene, sceneFiles, state } = this;
        if (!scene || !sceneFiles || !scene.is_random || scene.seed === state.seed) return;
        await this.openScene(sceneFiles.name, sceneFiles.parts, state.seed);
    }

    private async openScene(name: string, parts: Parts, seed: number | null): Promise<void> {
        const question = { ask: "open_scene", name, seed };
        const { head, parts: answer } = await this.engine.ask<SceneFacts>(question, parts);
        this.ground.show(head.map, answer["cells"] ?? new Uint8Array());
        this.forget();
        [this.scene, this.sceneFiles] = [head, { name, parts }];
        const robot = head.robots[0];
        Object.assign(this.state, {
            scene: new TextDecoder().decode(parts[name]),
            seed: head.seed,
            map: name,
            ...(robot ? { start: robot.start, goal: robot.goal } : {}),
        });
        this.say([head.description ?? name, ...head.map.warnings].join("; "));
    }

    private async openClaim(map: string): Promise<void> {
        const [, id, seed] = map.split(" ");
        const question = { ask: "open_claim", id, seed: seed ? Number(seed) : null };
        const { head, parts } = await this.engine.ask<ClaimMap>(question);
        const { drawn } = this.state;
        this.show(head.map, parts["cells"] ?? new Uint8Array(), map);
        this.state.drawn = drawn;
    }

    private leaveScene(): void {
        [this.scene, this.sceneFiles] = [null, null];
        Object.assign(this.state, { scene: null, sceneStack: "" });
    }

    /** Walls and obstacles of another map. */
    private forget(): void {
        Object.assign(this.state, { discs: [], walkers: [], drawn: [] });
    }

    private tell({ name, width, height, warnings }: MapFacts): void {
        this.say([`${name}, ${width} x ${height}`, ...warnings].join("; "));
    }
}
