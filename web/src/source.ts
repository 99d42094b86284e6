/** The sources of maps: bundled maps and scenes, own files, and claims of papers. */

import { bundledFiles, isBundled, isScene, load, loadScene } from "./bundled";
import type { Engine } from "./engine/engine";
import type { Message, Parts } from "./engine/message";
import type { ClaimMap, MapFacts, SceneFacts } from "./engine/types";
import type { Ground } from "./ground";
import type { Pair, State } from "./state";
import { texts } from "./texts";

/** Prefixes of the names of maps in a link. */
const SCENE = "scene ";
const CLAIM = "claim ";

interface Files {
    name: string;
    parts: Parts;
}

/** All that was on the map, beside the map itself. */
const placed = ({ start, goal, discs, walkers, drawn, scene, sceneStack, seed, map }: State) =>
    structuredClone({ start, goal, discs, walkers, drawn, scene, sceneStack, seed, map });

export class Source {
    /** The scene that is open; `null` for one that is drawn. */
    scene: SceneFacts | null = null;
    /** The files of that scene, for another seed. */
    private sceneFiles: Files | null = null;
    /** Own files of what is open, for a link. */
    files: Parts = {};
    /** Own files that were opened, and scenes of own tables, by the names in the list of maps. */
    private readonly own = new Map<string, Files>();
    /** The map and all on it before a claim was looked at. */
    private before: {
        opened: Message;
        placed: ReturnType<typeof placed>;
        scene: SceneFacts | null;
        sceneFiles: Files | null;
        files: Parts;
    } | null = null;

    constructor(
        private readonly engine: Engine,
        private readonly ground: Ground,
        private readonly state: State,
        private readonly say: (text: string) => void,
    ) {}

    /** Opens what a link names; where that is not to be had, the house, and says so. */
    async restore(files: Parts): Promise<string | null> {
        const linked = placed(this.state);
        const { map, scene, seed } = linked;
        if (files[map]) this.own.set(map, { name: map, parts: files });
        try {
            if (isBundled(map)) await this.openBundled(map);
            else if (map.startsWith(CLAIM)) await this.openClaim(map);
            else if (isScene(map.slice(SCENE.length))) await this.open(map);
            else if (this.own.has(map)) await this.open(map);
            else if (scene === null) throw new Error(map);
            else await this.openFiles({ name: map, parts: sceneAlone(map, scene) });
            await this.reseedTo(seed);
        } catch {
            await this.open("house");
            return texts.notInLink(map);
        }
        Object.assign(this.state, linked);
        this.ground.draw(this.engine, linked.drawn);
        return null;
    }

    /** True for what can be opened again. */
    isKnown(map: string): boolean {
        const scene = map.startsWith(SCENE) && isScene(map.slice(SCENE.length));
        return isBundled(map) || scene || map.startsWith(CLAIM) || this.own.has(map);
    }

    /** Opens something of the list of maps anew. */
    async open(map: string, stop?: AbortSignal): Promise<void> {
        const own = this.own.get(map);
        if (own) await this.openFiles(own, stop);
        else if (map.startsWith(CLAIM)) await this.openClaim(map, stop);
        else if (map.startsWith(SCENE)) {
            const files = await loadScene(map.slice(SCENE.length));
            stop?.throwIfAborted();
            await this.openScene(files, null, stop);
        } else {
            const [start, goal] = await this.openBundled(map, stop);
            this.forget();
            Object.assign(this.state, { start, goal });
        }
        this.state.map = map;
        [this.before, this.files] = [null, own?.parts ?? {}];
    }

    private async openBundled(map: string, stop?: AbortSignal): Promise<[Pair, Pair]> {
        const { name, parts, ends } = await load(map);
        stop?.throwIfAborted();
        const facts = await this.ground.open(this.engine, name, parts, stop);
        this.leaveScene();
        this.tell(facts);
        this.state.map = map;
        return ends;
    }

    /**
     * Own files: a map, a scene with its map, or a table of scenes. The names of what was opened,
     * and of what can be opened from now on.
     */
    async openOwn(files: File[], stop?: AbortSignal): Promise<string[]> {
        const named = (pattern: RegExp) => files.find(({ name }) => pattern.test(name));
        const first = named(/\.(toml|csv)$/i) ?? named(/\.(ya?ml|map)$/i) ?? files[0];
        if (!first) return [];
        const read = files.map(async (file): Promise<[string, Uint8Array]> => [
            file.name,
            new Uint8Array(await file.arrayBuffer()),
        ]);
        const parts = Object.fromEntries(await Promise.all(read));
        if (/\.csv$/i.test(first.name)) return this.openTable(first.name, parts, stop);
        const own = { name: first.name, parts };
        await this.openFiles(own, stop);
        this.own.set(first.name, own);
        [this.state.map, this.before, this.files] = [first.name, null, parts];
        return [first.name];
    }

    private async openFiles(files: Files, stop?: AbortSignal): Promise<void> {
        if (/\.toml$/i.test(files.name)) {
            // It may name a bundled map.
            const parts = { ...(await bundledFiles()), ...files.parts };
            await this.openScene({ ...files, parts }, null, stop);
            return;
        }
        this.tell(await this.ground.open(this.engine, files.name, files.parts, stop));
        this.leaveScene();
        this.forget();
        const { radius_m } = this.state;
        this.state.start = this.ground.freeNear(0.25, radius_m);
        this.state.goal = this.ground.freeNear(0.75, radius_m);
    }

    private async openTable(name: string, parts: Parts, stop?: AbortSignal): Promise<string[]> {
        const question = { ask: "barn_scenes", name };
        type Scenes = { name: string; text: string }[];
        const { head } = await this.engine.ask<Scenes>(question, parts, stop);
        for (const { name, text } of head) {
            this.own.set(name, { name, parts: sceneAlone(name, text) });
        }
        const names = head.map((scene) => scene.name);
        await this.open(names[0]!, stop);
        return names;
    }

    /** A map of a claim, which the part of the papers has opened. */
    show(facts: MapFacts, cells: Uint8Array, name: string): void {
        this.ground.show(facts, cells);
        this.leaveScene();
        this.forget();
        this.state.map = name;
    }

    /** Remembers what is there, before a claim is looked at. */
    remember(): void {
        const { opened } = this.engine;
        if (this.before || !opened || this.state.map.startsWith(CLAIM)) return;
        const { scene, sceneFiles, files } = this;
        this.before = { opened, placed: placed(this.state), scene, sceneFiles, files };
        this.files = {};
    }

    /** The map of the claim stays. */
    keep(): void {
        this.before = null;
    }

    /** Goes back to what was there before claims were looked at. */
    async goBack(): Promise<void> {
        const { before } = this;
        if (!before) return;
        this.before = null;
        const { head, parts } = await this.engine.reopen<MapFacts | SceneFacts>(before.opened);
        const facts = "map" in head ? head.map : head;
        this.ground.show(facts, parts["cells"] ?? new Uint8Array());
        Object.assign(this.state, before.placed);
        const { scene, sceneFiles, files } = before;
        Object.assign(this, { scene, sceneFiles, files });
        this.ground.draw(this.engine, before.placed.drawn);
    }

    /** The scene has another world with another seed. */
    async reseed(): Promise<void> {
        const { drawn, map, seed } = this.state;
        if (!(await this.reseedTo(seed))) return;
        Object.assign(this.state, { map, drawn });
        this.ground.draw(this.engine, drawn);
    }

    private async reseedTo(seed: number): Promise<boolean> {
        const { scene, sceneFiles } = this;
        if (!scene || !sceneFiles || !scene.is_random || scene.seed === seed) return false;
        await this.openScene(sceneFiles, seed);
        return true;
    }

    private async openScene(files: Files, seed: number | null, stop?: AbortSignal): Promise<void> {
        const { name, parts } = files;
        const question = { ask: "open_scene", name, seed };
        const { head, parts: answer } = await this.engine.ask<SceneFacts>(question, parts, stop);
        this.ground.show(head.map, answer["cells"] ?? new Uint8Array());
        this.forget();
        [this.scene, this.sceneFiles] = [head, files];
        const robot = head.robots[0];
        Object.assign(this.state, {
            scene: new TextDecoder().decode(parts[name]),
            seed: head.seed,
            map: name,
            ...(robot ? { start: robot.start, goal: robot.goal } : {}),
        });
        this.say([head.description ?? name, ...head.map.warnings].join("; "));
    }

    private async openClaim(map: string, stop?: AbortSignal): Promise<void> {
        const [, id, seed] = map.split(" ");
        const question = { ask: "open_claim", id, seed: seed ? Number(seed) : null };
        const { head, parts } = await this.engine.ask<ClaimMap>(question, {}, stop);
        this.show(head.map, parts["cells"] ?? new Uint8Array(), map);
        [this.state.start, this.state.goal] = head.ends;
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

const sceneAlone = (name: string, scene: string): Parts => ({
    [name]: new TextEncoder().encode(scene),
});
