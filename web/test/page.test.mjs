// The built page in a browser: what it shows, what it says of bad files, and that all of it can be
// used without seeing it.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { brotliCompressSync } from "node:zlib";
import { inBrowser, open, shot, status } from "./browser.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const cell = (page, name) =>
    page.locator(`#panel tr:has(th:text-is("${name}")) td`).first().textContent();

test("all that is loaded at first is small", async () => {
    await inBrowser({}, async (address, context, served) => {
        const page = await open(context, address);
        await status(page, /a path of/);
        const sizes = [...served].map((file) => brotliCompressSync(readFileSync(file)).length);
        const sum = sizes.reduce((a, b) => a + b);
        assert.ok(served.size >= 6, [...served].join(", "));
        assert.ok(sum <= 1_000_000, `${sum} bytes, expected at most a million`);
    });
});

test("a path follows start and goal, and a link shows it again", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        assert.equal(await status(page, /a path of/), "a path of 17.64 m with 7 turns");
        await shot(page, "plan");
        await page.getByLabel("Goal x [m]").fill("2.5");
        await page.getByLabel("Goal x [m]").blur();
        const shorter = await status(page, /a path of (?!17\.64)/);
        const length = await cell(page, "Length of the path");
        await page.getByRole("button", { name: "Copy a link" }).click();
        await status(page, /link/);
        const link = page.url();
        const other = await open(context, link);
        assert.equal(await status(other, /a path of/), shorter);
        assert.equal(await cell(other, "Length of the path"), length);
        await page.getByLabel("Goal x [m]").fill("99");
        await page.getByLabel("Goal x [m]").blur();
        await status(page, /outside the map/);
    });
});

test("a search is shown event by event", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Search" }).click();
        await page.locator("#panel").getByLabel("Planner").selectOption("astar");
        await page.locator('#panel td:text-is("3584")').waitFor();
        await status(page, /368\.65 cells/);
        await page.getByLabel("Event").fill("1");
        assert.equal(await cell(page, "Expanded so far"), "1");
        await shot(page, "search");
    });
});

test("a drive is that of the program", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Drive" }).click();
        await page.getByLabel("Actuation delay [s]").fill("0.1");
        await page.getByLabel("Noise of the lidar [m]").fill("0.02");
        await page.getByLabel("Noise of the lidar [m]").blur();
        await page.getByRole("button", { name: "Drive", exact: true }).click();
        await status(page, /the drive: reached after/);
        const time = await cell(page, "Time of the drive");
        const length = await cell(page, "Distance driven");
        await page.getByLabel("Moment").fill("150");
        await shot(page, "drive");
        const program = process.env.KEYWAY;
        if (!program) return;
        const folder = mkdtempSync(join(tmpdir(), "keyway-drive-"));
        const saved = async (name) => {
            const [file] = await Promise.all([
                page.waitForEvent("download"),
                page.getByRole("button", { name }).click(),
            ]);
            const path = join(folder, file.suggestedFilename());
            await file.saveAs(path);
            return path;
        };
        const report = JSON.parse(readFileSync(await saved("Save the report"), "utf8"));
        assert.equal(time, `${report.run.time_s.toFixed(1)} s`);
        assert.equal(length, `${report.run.length_m.toFixed(2)} m`);
        const scene = await saved("Save the scene");
        for (const name of ["small_house.yaml", "small_house.png"]) {
            const bundled = new URL(`../../crates/keyway-cli/scenes/${name}`, import.meta.url);
            copyFileSync(bundled, join(folder, name));
        }
        const line = ["navigate", "--scene", "scene.toml", "--format", "json"];
        const own = JSON.parse(execFileSync(program, line, { cwd: dirname(scene) }));
        assert.equal(JSON.stringify(withoutTimes(report)), JSON.stringify(withoutTimes(own)));
        rmSync(folder, { recursive: true });
    });
});

/** What does not depend on a clock, or on where the report was made. */
function withoutTimes({ files: _, ...report }) {
    for (const part of [report.plan, report.smoothed]) delete part.time_s;
    delete report.run.mean_cycle_us;
    return report;
}

test("work can be stopped, and nothing is lost", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Drive" }).click();
        await page.getByRole("button", { name: "Drive", exact: true }).click();
        await page.getByRole("button", { name: "Stop" }).click();
        await status(page, /Stopped/);
        await page.getByRole("tab", { name: "Plan" }).click();
        assert.equal(await status(page, /a path of/), "a path of 17.64 m with 7 turns");
    });
});

test("own maps are opened, and bad ones leave what was there", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        const give = (name, text) =>
            page
                .locator("#files")
                .setInputFiles({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
        await give("cut.map", "type octile\nheight 2\nwidth 3\nmap\n...\n..");
        await status(page, /cut\.map: line 6: the row has 2 characters, expected 3/);
        await give("strange.txt", "hello");
        await status(page, /expected a file name that ends in/);
        await give(
            "alone.yaml",
            "image: none.png\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        );
        await status(page, /none\.png/);
        await page.getByLabel("Planner").selectOption("astar");
        assert.match(await status(page, /a path of/), /17\.\d+ m/);
        await give("own.map", "type octile\nheight 4\nwidth 4\nmap\n....\n....\n....\n....\n");
        await status(page, /a path of 4\.24 m/);
        // It is in the link, unless it is too large.
        await page.getByRole("button", { name: "Copy a link" }).click();
        await status(page, /the link|clipboard/);
        const other = await open(context, page.url());
        await status(other, /a path of 4\.24 m/);
        // Pixels that nothing makes smaller.
        let seed = 1;
        const pixels = Array.from({ length: 1200 * 1200 }, () => {
            seed = (seed * 48271) % 2147483647;
            return seed & 255;
        });
        const buffer = Buffer.concat([Buffer.from("P5\n1200 1200\n255\n"), Buffer.from(pixels)]);
        const file = { name: "noise.pgm", mimeType: "image/x-portable-graymap", buffer };
        await page.locator("#files").setInputFiles(file);
        await status(page, /a path of (?!4\.24)|no path|obstacle|no cell/);
        await page.getByRole("button", { name: "Copy a link" }).click();
        await status(page, /too large for a link/);
    });
});

/** Files that cannot be used, and what is said of them. */
const BAD = [
    ["empty.map", "", /empty\.map/],
    ["kind.map", "type hexagons\nheight 1\nwidth 1\nmap\n.\n", /kind\.map: line 1/],
    ["huge.map", "type octile\nheight 99999\nwidth 99999\nmap\n", /huge\.map/],
    ["short.map", "type octile\nheight 2\nwidth 2\nmap\n..\n", /short\.map: line 5/],
    ["no.pgm", "P5\n4 4\n255\n..", /no\.pgm/],
    ["text.png", "this is no picture", /text\.png/],
    ["list.yaml", "- 1\n- 2\n", /list\.yaml/],
    ["res.yaml", "image: a.png\nresolution: -1\norigin: [0, 0, 0]\n", /res\.yaml/],
    ["binary.yaml", Buffer.from([0xff, 0xfe, 0x00, 0x80]), /binary\.yaml/],
    ["empty.toml", "", /empty\.toml: .*scene/],
    ["binary.toml", Buffer.from([0xff, 0xfe, 0x00, 0x80]), /binary\.toml: .*UTF-8/],
    ["old.toml", "version = 99\n", /old\.toml: .*99/],
    [
        "robot.toml",
        "version = 2\nrobot = 7\nstart = [0, 0]\ngoal = [1, 1]\n",
        /robot\.toml: .*robot/,
    ],
    ["empty.csv", "world,x,y,radius\n", /empty\.csv/],
];

test("files that cannot be used leave what was there", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await status(page, /17\.64 m/);
        for (const [name, content, expected] of BAD) {
            const buffer = Buffer.from(content);
            await page.locator("#files").setInputFiles({ name, mimeType: "text/plain", buffer });
            await status(page, expected);
            // The map and its path are still there.
            await page.getByLabel("Smoother").selectOption("none");
            await status(page, /a path of (?!17\.64)/);
            await page.getByLabel("Smoother").selectOption("taut");
            await status(page, /a path of 17\.64 m/);
        }
    });
});

for (const colorScheme of ["light", "dark"]) {
    test(`everything can be used without seeing it (${colorScheme})`, async () => {
        await inBrowser({ colorScheme }, async (address, context) => {
            const page = await open(context, address);
            await page.evaluate(AXE);
            for (const tab of ["Plan", "Search", "Drive", "Compare", "Papers"]) {
                await page.getByRole("tab", { name: tab }).click();
                await page.waitForTimeout(300);
                if (tab === "Compare") {
                    await page.getByRole("button", { name: "Compare them" }).click();
                    await status(page, /compared: 3 rows/);
                }
                const { violations } = await page.evaluate(() => globalThis.axe.run());
                const found = violations.map(
                    ({ id, nodes }) => `${id}: ${nodes.map((it) => it.html).join(" ")}`,
                );
                assert.deepEqual(found, [], `${tab}: ${found.join("\n")}`);
                await shot(page, `${tab}-${colorScheme}`);
            }
            const picture = page.getByRole("img");
            assert.match(await picture.getAttribute("aria-label"), /Picture of the map: /);
        });
    });
}

test("a small screen shows the map first", async () => {
    await inBrowser({ viewport: { width: 390, height: 844 } }, async (address, context) => {
        const page = await open(context, address);
        await status(page, /a path of/);
        const width = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(width <= 390, `${width} pixels wide`);
        await shot(page, "phone");
    });
});

/** A link with this state. */
async function linkTo(address, state) {
    const { deflateRawSync } = await import("node:zlib");
    return `${address}#${deflateRawSync(JSON.stringify(state)).toString("base64url")}`;
}

test("links that are damaged show what they can", async () => {
    await inBrowser({}, async (address, context) => {
        const states = [
            { tab: "foo", start: null, map: "constructor", walls: [[0.5, 1]] },
            {
                drawn: [
                    [600, 100, 1],
                    [1e12, 1, 1],
                    [1, 1, 7],
                ],
                discs: [{ at: [0, 0], radius_m: -1 }],
            },
            { start: ["a", "b"], walkers: [{ from: [0, 0] }], seed: "0\nmap = 1", radius_m: -3 },
            [1, 2],
        ];
        const links = await Promise.all(states.map((state) => linkTo(address, state)));
        for (const link of [...links, `${address}#%%%`, `${address}#AAAA`]) {
            const page = await open(context, link);
            assert.match(await status(page, /a path of|is not in the link/), /./);
            await page.getByLabel("Planner").selectOption("astar");
            assert.match(await status(page, /a path of/), /17\.\d+ m/);
            await page.close();
        }
    });
});

test("walls that are drawn stay through a stop, and in links", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await status(page, /17\.64 m/);
        await page.getByLabel("The pointer").selectOption("wall");
        const map = await page.locator("#map").boundingBox();
        const across = async () => {
            const [x, y] = [map.x + 0.52 * map.width, map.y + 0.35 * map.height];
            await page.mouse.move(x, y);
            await page.mouse.down();
            await page.mouse.move(x, y + 0.15 * map.height, { steps: 3 });
            await page.mouse.up();
        };
        await page.getByRole("tab", { name: "Drive" }).click();
        await page.getByRole("button", { name: "Drive", exact: true }).click();
        await across();
        await page.getByRole("tab", { name: "Plan" }).click();
        const around = await status(page, /a path of (?!17\.64)/);
        await page.getByRole("button", { name: "Copy a link" }).click();
        await status(page, /link/);
        const other = await open(context, page.url());
        assert.equal(await status(other, /a path of/), around);
        await page.getByLabel("The pointer").selectOption("erase");
        await across();
        // A little of the wall may be left where the map is shown elsewhere now.
        await status(page, /a path of 17\./);
    });
});

test("a drive that no longer counts is not shown", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Drive" }).click();
        await page.getByRole("button", { name: "Drive", exact: true }).click();
        await page.getByLabel("Goal x [m]").fill("2.5");
        await page.getByLabel("Goal x [m]").blur();
        await status(page, /Press Drive|Stopped/);
        assert.equal(await page.locator("#panel table").count(), 0);
        await page.getByRole("button", { name: "Drive", exact: true }).click();
        const shown = await status(page, /the drive: reached/);
        // Still there after a look at another part.
        await page.getByRole("tab", { name: "Plan" }).click();
        await status(page, /a path of/);
        await page.getByRole("tab", { name: "Drive" }).click();
        assert.notEqual(await page.locator("#panel table").count(), 0, shown);
    });
});
