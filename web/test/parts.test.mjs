// Searches side by side, scenes, comparisons and claims in a browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { inBrowser, open, shot, status } from "./browser.mjs";

const choose = (page, label, value) => page.locator("#panel").getByLabel(label).selectOption(value);
const chooseMap = (page, map) =>
    page.locator("#controls").getByLabel("Map", { exact: true }).selectOption(map);
const press = (page, name) => page.getByRole("button", { name, exact: true }).click();
const row = (page, name) => page.locator(`tr:has(th:text-is("${name}")) td`).allTextContents();

async function fill(page, label, value) {
    await page.getByLabel(label).fill(value);
    await page.getByLabel(label).blur();
}

test("four searches side by side", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Search" }).click();
        await choose(page, "Planner", "astar");
        await choose(page, "Fourth picture", "rrt");
        await choose(page, "Second picture", "jps");
        await choose(page, "Third picture", "bidirectional-optimal");
        await status(page, /astar: .*368\.65.*jps: .*368\.65.*bidirectional.*368\.65.*rrt/);
        assert.deepEqual((await row(page, "Expanded so far")).slice(0, 2), ["3584", "7"]);
        await shot(page, "searches");
        await page.getByLabel("Event").fill("1");
        await press(page, "Forward");
        assert.deepEqual(await row(page, "Generated so far"), ["1", "0", "1", "1"]);
        await press(page, "Back");
        assert.equal((await row(page, "Expanded so far"))[0], "1");
        const other = await open(context, await link(page));
        await status(other, /astar: .*jps: .*bidirectional-optimal: .*rrt/);
        assert.deepEqual((await row(other, "Expanded so far")).slice(0, 2), ["3584", "7"]);
    });
});

/** The address that holds everything. */
async function link(page) {
    await press(page, "Copy a link to this");
    await status(page, /link/);
    return page.url();
}

test("a scene with several robots, and a link to it", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Drive" }).click();
        await chooseMap(page, "scene fleet/crossing");
        await status(page, /Press Drive to simulate the scene/);
        await press(page, "Drive");
        const driven = await status(page, /1: the drive: reached after .*2: the drive: reached/);
        assert.deepEqual(await row(page, "Outcome"), ["reached", "reached"]);
        await page.getByLabel("Show the velocities").check();
        await page.getByLabel("Moment").fill("60");
        await shot(page, "robots");
        const [picture] = await Promise.all([
            page.waitForEvent("download"),
            press(page, "Save as SVG"),
        ]);
        const svg = readFileSync(await picture.path(), "utf8");
        assert.match(svg, /^<svg .*<image .*<path .*<text .*<\/svg>\n$/s);
        assert.equal(svg.split("<g ").length, svg.split("</g>").length);
        const drawn = await context.newPage();
        await drawn.setContent(svg);
        await shot(drawn, "svg");
        await drawn.close();
        await choose(page, "Robot whose view is shown", "1");
        assert.equal((await row(page, "Time"))[0], "6.0 s");
        const other = await open(context, await link(page));
        await press(other, "Drive");
        assert.equal(await status(other, /1: the drive/), driven);
        await choose(other, "Stack", "s0-key-point");
        await status(other, /Press Drive to simulate the scene/);
    });
});

test("a scene that needs the house is opened from anywhere, with the house as it is", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await status(page, /17\.64 m/);
        await page.getByRole("tab", { name: "Drive" }).click();
        await chooseMap(page, "scene complaints/blocked_path");
        await status(page, /Press Drive to simulate the scene/);
        await press(page, "Drive");
        const driven = await status(page, /the drive: reached after [^;]*$/);
        // A wall of the house is not one of the scene's.
        await chooseMap(page, "house");
        await status(page, /Press Drive to simulate the drive/);
        await page.getByLabel("The pointer").selectOption("wall");
        const map = await page.locator("#map").boundingBox();
        await page.mouse.move(map.x + 0.52 * map.width, map.y + 0.35 * map.height);
        await page.mouse.down();
        await page.mouse.move(map.x + 0.52 * map.width, map.y + 0.5 * map.height, { steps: 3 });
        await page.mouse.up();
        await chooseMap(page, "scene complaints/blocked_path");
        await status(page, /Press Drive to simulate the scene/);
        await press(page, "Drive");
        assert.equal(await status(page, /the drive: reached after [^;]*$/), driven);
        const other = await open(context, await link(page));
        await press(other, "Drive");
        assert.equal(await status(other, /the drive: reached after [^;]*$/), driven);
    });
});

test("the last map that is chosen is shown", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.route(/small_house.*png/, async (route) => {
            await new Promise((later) => setTimeout(later, 1000));
            await route.continue();
        });
        await chooseMap(page, "scene fleet/bay");
        await chooseMap(page, "rooms");
        await status(page, /a path of 4\d\.\d+ m/);
        await page.waitForTimeout(1500);
        assert.match(await page.locator("#status").textContent(), /a path of 4\d\.\d+ m/);
        assert.equal(await page.locator("#controls select").first().inputValue(), "rooms");
    });
});

test("own scenes are opened, with a world of their own or with their map", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Drive" }).click();
        const given = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
        const bundled = (name) => {
            const path = new URL(`../../scenes/fleet/${name}`, import.meta.url);
            return given(name, readFileSync(path));
        };
        await page.locator("#files").setInputFiles(bundled("bay.toml"));
        await status(page, /its map `bay\.yaml` is missing/);
        await page.locator("#files").setInputFiles(given("bad.toml", "version = 2\nmap = 1\n"));
        await status(page, /map/);
        const files = ["bay.toml", "bay.yaml", "bay.pgm"].map(bundled);
        await page.locator("#files").setInputFiles(files);
        await status(page, /Press Drive to simulate the scene/);
        const table = "world,x,y,radius\n7,-2.0,8.0,0.075\n9,-2.2,5.0,0.3\n";
        await page.locator("#files").setInputFiles(given("worlds.csv", table));
        await status(page, /Press Drive to simulate the scene/);
        await chooseMap(page, "barn_009.toml");
        await press(page, "Drive");
        await status(page, /the drive: reached after/);
        const world =
            "version = 2\nseed = 4\nstart = [1.0, 1.0]\ngoal = [9.0, 9.0]\n[world]\nwidth_m = 10.0\n" +
            "height_m = 10.0\nresolution_m = 0.1\nobstacles = { blocks = { share = 0.12, side_m = [0.2, 0.6] } }\n";
        await page.locator("#files").setInputFiles(given("made.toml", world));
        await status(page, /Press Drive to simulate the scene/);
        await press(page, "Drive");
        const driven = await status(page, /the drive: reached after/);
        const other = await open(context, await link(page));
        await press(other, "Drive");
        assert.equal(await status(other, /the drive: reached after/), driven);
        // Another seed is another world, in all parts.
        const planned = async () => {
            await other.getByRole("tab", { name: "Plan" }).click();
            const text = await status(other, /a path of/);
            await other.getByRole("tab", { name: "Drive" }).click();
            return text;
        };
        const before = await planned();
        await fill(other, "Seed", "6");
        await status(other, /Press Drive/);
        assert.notEqual(await planned(), before);
        await status(other, /Press Drive/);
        await press(other, "Drive");
        assert.notEqual(await status(other, /the drive: /), driven);
    });
});

test("stacks race, and planners answer the same queries", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Compare" }).click();
        await fill(page, "Runs of each stack", "2");
        await press(page, "Compare them");
        await status(page, /compared: 3 rows/);
        assert.equal((await row(page, "keyway"))[0], "2/2");
        await page.getByLabel("Moment").fill("100");
        await shot(page, "race");
        const [file] = await Promise.all([
            page.waitForEvent("download"),
            press(page, "All runs as CSV"),
        ]);
        const runs = readFileSync(await file.path(), "utf8")
            .trim()
            .split("\n");
        assert.equal(runs.length, 1 + 3 * 2);
        await choose(page, "Compare", "planners");
        await status(page, /Press Compare them to answer/);
        await press(page, "Compare them");
        await status(page, /compared: 4 rows/);
        assert.equal((await row(page, "theta-star"))[1], "20/20");
    });
});

test("a long comparison is stopped", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Compare" }).click();
        await fill(page, "Runs of each stack", "100");
        await press(page, "Compare them");
        await status(page, /[1-9]\d* of 300 drives/);
        await press(page, "Stop");
        await status(page, /Stopped/);
        await page.getByRole("tab", { name: "Plan" }).click();
        await status(page, /a path of 17\.64 m/);
    });
});

test("a claim is shown and measured", async () => {
    await inBrowser({}, async (address, context) => {
        const page = await open(context, address);
        await page.getByRole("tab", { name: "Papers" }).click();
        await status(page, /S0-1 on scene of S0-1/);
        assert.deepEqual((await row(page, "astar")).slice(0, 1), ["29.21"]);
        await fill(page, "Maps to measure", "6");
        await status(page, /S0-1 on/);
        await press(page, "Measure again");
        await status(page, /measured on 6 maps/);
        assert.match(await page.locator("#wide").textContent(), /Verdict: .*Published/);
        await shot(page, "papers");
        const other = await open(context, await link(page));
        await status(other, /S0-1 on scene of S0-1/);
        await choose(other, "Claim", "S1-4");
        await status(other, /S1-4 on/);
        assert.match((await row(other, "dwa-to-goal"))[0], /did not arrive/);
        // The map of before comes back, unless that of the claim is kept.
        await page.getByRole("tab", { name: "Plan" }).click();
        await status(page, /a path of 17\.64 m/);
        await page.getByRole("tab", { name: "Papers" }).click();
        await status(page, /S0-1 on/);
        await press(page, "Use this map in the other parts");
        await status(page, /a path of (?!17\.64)/);
    });
});
