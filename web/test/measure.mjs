// Times of the page in a browser: printed, never judged. Run it on a quiet machine.

import { gzipSync, brotliCompressSync } from "node:zlib";
import { readFileSync } from "node:fs";
import { inBrowser, open, status } from "./browser.mjs";

const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
const megabytes = (bytes) => `${(bytes / 1e6).toFixed(2)} MB`;

/** The sizes of all that a browser loads until the page answers. */
function sizes(served) {
    const contents = [...served].map((file) => readFileSync(file));
    const sum = (pack) => contents.reduce((all, content) => all + pack(content).length, 0);
    const [brotli, gzip] = [
        sum((it) => brotliCompressSync(it)),
        sum((it) => gzipSync(it, { level: 9 })),
    ];
    console.log(`loaded at first: ${megabytes(brotli)} by brotli, ${megabytes(gzip)} by gzip`);
}

/** An open map of 512 x 512 cells with blocks in it. */
function blocks() {
    const rows = Array.from({ length: 512 }, (_, y) =>
        Array.from({ length: 512 }, (_, x) => (x % 37 < 9 && (y * 7 + x) % 41 < 15 ? "@" : ".")),
    );
    return `type octile\nheight 512\nwidth 512\nmap\n${rows.map((row) => row.join("")).join("\n")}\n`;
}

/** The longest time for which the page does not answer, while a large map is opened. */
async function frozen(context, address) {
    const page = await open(context, address);
    await status(page, /a path of/);
    // A file that is made in the page: what a test hands over takes time of its own.
    await page.evaluate(() => {
        const row = `${".".repeat(4096)}\n`;
        const head = "type octile\nheight 4096\nwidth 4096\nmap\n";
        const files = new DataTransfer();
        files.items.add(new File([head, row.repeat(4096)], "large.map"));
        globalThis.longest_ = 0;
        const watch = new PerformanceObserver((list) => {
            for (const { duration } of list.getEntries()) {
                globalThis.longest_ = Math.max(globalThis.longest_, duration);
            }
        });
        const input = document.querySelector("#files");
        input.files = files.files;
        setTimeout(() => {
            watch.observe({ type: "longtask" });
            input.dispatchEvent(new Event("change"));
        }, 500);
    });
    await status(page, /a path of (?!17)/);
    await page.waitForTimeout(1000);
    const longest = await page.evaluate(() => globalThis.longest_);
    console.log(`4096 x 4096 opened: the page did not answer for ${longest.toFixed(0)} ms at most`);
    await page.close();
}

await inBrowser({}, async (address, context, served) => {
    await (await open(context, address)).close();
    sizes(served);
    await frozen(context, address);
    const page = await open(context, address);
    const ready = await page.evaluate(() => performance.now());
    console.log(`answers after ${ready.toFixed(0)} ms`);
    await page.locator("#files").setInputFiles({
        name: "blocks.map",
        mimeType: "text/plain",
        buffer: Buffer.from(blocks()),
    });
    await status(page, /a path of/);
    const map = await page.locator("#map").boundingBox();
    const at = (x, y) => [map.x + x * map.width, map.y + y * map.height];
    // The goal, wherever it is, is taken to the middle first.
    for (const [label, value] of [
        ["Goal x [m]", "256.5"],
        ["Goal y [m]", "256.5"],
    ]) {
        await page.getByLabel(label).fill(value);
        await page.getByLabel(label).blur();
    }
    await page.waitForTimeout(500);
    await page.evaluate(() => {
        globalThis.frames_ = [];
        globalThis.times_ = [];
        const frame = (now) => {
            globalThis.frames_.push(now);
            requestAnimationFrame(frame);
        };
        requestAnimationFrame(frame);
        new MutationObserver(() => {
            const cells = [...document.querySelectorAll("#panel td")];
            const time = cells.map((it) => it.textContent).find((text) => / ms$/.test(text));
            if (time) globalThis.times_.push(parseFloat(time));
        }).observe(document.querySelector("#panel"), { childList: true, subtree: true });
    });
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down();
    for (let i = 0; i < 240; i++) {
        const angle = (i / 240) * 2 * Math.PI;
        await page.mouse.move(...at(0.5 + 0.2 * Math.sin(angle), 0.5 + 0.25 * Math.sin(2 * angle)));
        await page.waitForTimeout(8);
    }
    await page.mouse.up();
    const { frames, times } = await page.evaluate(() => ({
        frames: globalThis.frames_,
        times: globalThis.times_,
    }));
    const gaps = frames.slice(1).map((now, i) => now - frames[i]);
    const rate = (1000 * gaps.length) / (frames.at(-1) - frames[0]);
    console.log(`planned again ${times.length} times while the goal was dragged over 512 x 512:`);
    console.log(`    median ${median(times).toFixed(1)} ms, longest ${Math.max(...times)} ms`);
    console.log(
        `    ${rate.toFixed(0)} frames a second, longest gap ${Math.max(...gaps).toFixed(0)} ms`,
    );
});
