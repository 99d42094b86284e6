// Writes the moving picture of the README: npm install --no-save gifenc pngjs, then
// node test/film.mjs ../docs/images/playground.gif

import { writeFileSync } from "node:fs";
import { deflateRawSync } from "node:zlib";
import gifenc from "gifenc";
import { PNG } from "pngjs";
import { inBrowser, open, status } from "./browser.mjs";

const { GIFEncoder, quantize, applyPalette } = gifenc;
const [WIDTH, HEIGHT] = [1040, 620];
/** Every so many cycles is a frame; a cycle takes 0.1 s. */
const STEP = 6;
const COLORS = 63;
const DELAY_MS = 120;

const state = {
    tab: "drive",
    fan: true,
    discs: [{ at: [0.3, -0.275], radius_m: 0.15 }],
    walkers: [
        { from: [2.4, 3.2], to: [2.4, -0.6] },
        { from: [4.6, 2.4], to: [6.2, -0.4] },
    ],
};

await inBrowser({ viewport: { width: WIDTH, height: HEIGHT } }, async (address, context) => {
    const link = deflateRawSync(JSON.stringify(state)).toString("base64url");
    const page = await open(context, `${address}#${link}`);
    await page.getByRole("button", { name: "Drive", exact: true }).click();
    await status(page, /the drive: reached/);
    // Reasons come after the drive.
    await page.locator('th:text-is("Why this velocity")').waitFor();
    // The decisions beside the picture.
    await page.getByLabel("Moment").scrollIntoViewIfNeeded();
    await page.evaluate(() => {
        const at = document.querySelector("#panel input[type=range]").getBoundingClientRect();
        scrollBy(0, at.top - 40);
    });
    const last = Number(await page.getByLabel("Moment").getAttribute("max"));
    const gif = GIFEncoder();
    let [palette, before] = [null, null];
    for (let cycle = 0; cycle <= last; cycle += STEP) {
        await page.getByLabel("Moment").fill(String(cycle));
        await page.waitForTimeout(60);
        const { data, width, height } = PNG.sync.read(await page.screenshot());
        palette ??= quantize(data, COLORS);
        const now = applyPalette(data, palette);
        // Pixels that stay are left out: the last colour is not drawn.
        const shown = before ? now.map((color, i) => (color === before[i] ? COLORS : color)) : now;
        const colors = [...palette];
        while (colors.length <= COLORS) colors.push([0, 0, 0]);
        const holes = before ? { transparent: true, transparentIndex: COLORS, dispose: 1 } : {};
        gif.writeFrame(shown, width, height, { palette: colors, delay: DELAY_MS, ...holes });
        before = now;
    }
    gif.finish();
    writeFileSync(process.argv[2], gif.bytes());
});
