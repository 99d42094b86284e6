// The module of WebAssembly against the same library on this machine: every answer is the same to
// the last byte. NATIVE is the example `native` of crates/keyway-web.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";

const SCENES = new URL("../../crates/keyway-cli/scenes/", import.meta.url);
const file = (name) => readFileSync(new URL(name, SCENES));

function bytesOf(head, parts = {}) {
    const texts = [JSON.stringify(head), ...Object.entries(parts).flat()].map((text) =>
        Buffer.from(text),
    );
    return Buffer.concat(texts.flatMap((text) => [lengthOf(text), text]));
}

function lengthOf(content) {
    const length = Buffer.alloc(4);
    length.writeUInt32LE(content.length);
    return length;
}

/** A library of its own for each list of questions. */
function inModule(questions) {
    const module = new WebAssembly.Module(
        readFileSync(new URL("../src/keyway.wasm", import.meta.url)),
    );
    assert.deepEqual(WebAssembly.Module.imports(module), []);
    const library = new WebAssembly.Instance(module, {}).exports;
    return questions.map((question) => {
        const at = library.room(question.length);
        new Uint8Array(library.memory.buffer, at, question.length).set(question);
        const from = library.ask();
        return Buffer.from(new Uint8Array(library.memory.buffer, from, library.answer_bytes()));
    });
}

function natively(questions) {
    const input = Buffer.concat(questions.flatMap((question) => [lengthOf(question), question]));
    const output = execFileSync(process.env.NATIVE, { input, maxBuffer: 1 << 30 });
    const answers = [];
    for (let at = 0; at < output.length;) {
        const length = output.readUInt32LE(at);
        answers.push(output.subarray(at + 4, at + 4 + length));
        at += 4 + length;
    }
    return answers;
}

function equal(questions, accepts) {
    const [own, others] = [inModule(questions), natively(questions)];
    assert.equal(own.length, others.length);
    questions.forEach((question, i) => {
        const about = question.subarray(4, 200).toString();
        const head = JSON.parse(headOf(own[i]));
        accepts(head, about);
        assert.ok(own[i].equals(others[i]), `another answer to ${about}`);
    });
}

const openHouse = bytesOf(
    { ask: "open_map", name: "small_house.yaml" },
    { "small_house.yaml": file("small_house.yaml"), "small_house.png": file("small_house.png") },
);
const openRooms = bytesOf(
    { ask: "open_map", name: "rooms.map" },
    { "rooms.map": file("rooms.map") },
);
const headOf = (answer) => answer.subarray(4, 4 + answer.readUInt32LE(0)).toString();
const names = () => JSON.parse(headOf(inModule([bytesOf({ ask: "names" })])[0]));
const skip = process.env.NATIVE ? false : "NATIVE is not given";

test("every planner and every smoother", { skip }, () => {
    const { planners, smoothers } = names();
    const ends = { start: [-8.175, -2.825], goal: [8.725, 0.875], radius_m: 0.2 };
    const inRooms = { start: [1.5, 1.5], goal: [30.5, 30.5], radius_m: 0 };
    const ask = (given) =>
        planners.flatMap((planner) => [
            bytesOf({ ask: "search", planner, ...given }),
            bytesOf({ ask: "plan", planner, smoother: "taut", ...given }),
        ]);
    const smoothed = smoothers.map((smoother) =>
        bytesOf({ ask: "plan", planner: "jps", smoother, ...ends }),
    );
    const questions = [openHouse, ...ask(ends), ...smoothed, openRooms, ...ask(inRooms)];
    let found = 0;
    equal(questions, (head) => {
        found += Number(head.outcome === "found" || head.cost_cells > 0);
    });
    assert.ok(found > 60, `${found} paths of ${questions.length} answers`);
});

/** The cases of `testdata/plan`, as its README says. */
function cases() {
    const folder = new URL("../../testdata/plan/", import.meta.url);
    const files = readdirSync(folder).filter((name) => name.endsWith(".toml"));
    const texts = files.map((name) => readFileSync(new URL(name, folder), "utf8"));
    return texts
        .flatMap((text) => text.split("[[case]]").slice(1))
        .map((text) => {
            const rows = text.match(/map = "+\n?([^"]*?)\n?"/)[1].split("\n");
            const end = (name) => JSON.parse(text.match(new RegExp(`${name} = (\\[.*\\])`))[1]);
            return { rows, start: end("start"), goal: end("goal") };
        });
}

test("every planner on the cases that every shell gives", { skip }, () => {
    const { planners } = names();
    const centre = ([x, y]) => [x + 0.5, y + 0.5];
    const questions = cases().flatMap(({ rows, start, goal }) => {
        const drawn = rows.map((row) => row.replaceAll(/[#?]/g, "@")).join("\n");
        const size = `height ${rows.length}\nwidth ${rows[0].length}`;
        const map = Buffer.from(`type octile\n${size}\nmap\n${drawn}\n`);
        const ends = { start: centre(start), goal: centre(goal), radius_m: 0 };
        return [
            bytesOf({ ask: "open_map", name: "case.map" }, { "case.map": map }),
            ...planners.map((planner) => bytesOf({ ask: "search", planner, ...ends })),
        ];
    });
    let found = 0;
    equal(questions, (head) => (found += Number(head.cost_cells > 0)));
    assert.ok(found > 100, `${found} paths of ${questions.length} answers`);
});

test("scenes, comparisons and claims", { skip }, () => {
    const fleet = (name) => readFileSync(new URL(`../../scenes/fleet/${name}`, import.meta.url));
    const bay = Object.fromEntries(
        ["bay.toml", "bay.yaml", "bay.pgm"].map((name) => [name, fleet(name)]),
    );
    const claims = JSON.parse(headOf(inModule([bytesOf({ ask: "claims" })])[0]));
    const drive = { ask: "drive", scene: bay["bay.toml"].toString(), stack: "s0-key-point" };
    const compare = { planners: ["jps", "theta-star"], smoothers: ["none", "taut"], radius_m: 0.2 };
    const questions = [
        bytesOf({ ask: "claims" }),
        bytesOf({ ask: "open_scene", name: "bay.toml" }, bay),
        bytesOf({ ...drive, name: "bay", without_reasons: true }),
        openHouse,
        bytesOf({ ask: "compare", ...compare, queries: 5, seed: 1 }),
        ...claims.flatMap(({ id }) => [
            bytesOf({ ask: "open_claim", id, seed: 2 }),
            bytesOf({ ask: "measure_claim", id, seed: 3 }),
        ]),
    ];
    const rows = claims.map(({ id }) => {
        const [row] = inModule([bytesOf({ ask: "measure_claim", id, seed: 4 })]);
        return bytesOf({ ask: "judge_claim", id, rows: [JSON.parse(headOf(row))] });
    });
    equal([...questions, ...rows], (head, about) => {
        assert.equal(head.error, undefined, `${about}: ${head.error?.message}`);
    });
});

test("every stack in three scenes", { skip }, () => {
    const scene = (stack, more) =>
        `${file("small_house.toml")}`
            .replace("[[unknown]]", `${more}\n[[unknown]]`)
            .replace('robot = "small"', `robot = "small"\nstack = "${stack}"`)
            .replace("version = 1", "version = 2\nseed = 7");
    const scenes = [
        "",
        "[[moving]]\nposition = [2.0, -3.0]\nradius_m = 0.25\nvelocity_mps = [0.0, 0.4]\n",
        "[disturbances]\nactuation = { delay_s = 0.1 }\nsensor = { range_m = 0.02 }\n",
    ];
    const questions = names().stacks.flatMap((stack) =>
        scenes.map((more) => bytesOf({ ask: "drive", scene: scene(stack, more) })),
    );
    let reached = 0;
    equal([openHouse, ...questions], (head, about) => {
        assert.equal(head.error, undefined, `${about}: ${head.error?.message}`);
        reached += Number(head.reports?.[0].outcome === "reached");
    });
    assert.ok(reached > 20, `${reached} of ${questions.length} drives reached their goal`);
});
