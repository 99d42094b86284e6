// A browser and a server of the built page, for tests.

import { mkdirSync, readFileSync, mkdtempSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join } from "node:path";
import { chromium } from "playwright-core";

const DIST = new URL("../dist/", import.meta.url).pathname;
const TYPES = {
    ".html": "text/html",
    ".js": "text/javascript",
    ".css": "text/css",
    ".wasm": "application/wasm",
};
const ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

/** Calls `use` with the address of the page, a context of a browser, and the files it loaded. */
export async function inBrowser(options, use) {
    const served = new Set();
    const server = createServer((question, answer) => {
        const path = new URL(question.url, "http://localhost").pathname;
        try {
            const file = join(DIST, path === "/" ? "index.html" : decodeURIComponent(path));
            const content = readFileSync(file);
            served.add(file);
            answer.writeHead(200, {
                "content-type": TYPES[extname(file)] ?? "application/octet-stream",
            });
            answer.end(content);
        } catch {
            answer.writeHead(404).end();
        }
    });
    await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
    const profile = mkdtempSync(join(tmpdir(), "keyway-web-"));
    const context = await chromium.launchPersistentContext(profile, {
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        headless: true,
        viewport: { width: 1280, height: 860 },
        args: ARGUMENTS,
        ...options,
    });
    try {
        await use(`http://127.0.0.1:${server.address().port}/`, context, served);
    } finally {
        await context.close();
        server.close();
        rmSync(profile, { recursive: true, force: true });
    }
}

/** Opens the page, or another state of it, and waits until it answers; its faults are thrown. */
export async function open(context, address) {
    const page = await context.newPage();
    page.on("pageerror", (error) => {
        throw error;
    });
    page.on("console", (message) => {
        if (message.type() === "error") throw new Error(message.text());
    });
    await page.goto(address);
    await page.waitForSelector("body[data-ready]");
    return page;
}

/** A picture of the page, where SCREENSHOTS names a folder. */
export async function shot(page, name) {
    const folder = process.env.SCREENSHOTS;
    if (!folder) return;
    mkdirSync(folder, { recursive: true });
    await page.screenshot({ path: join(folder, `${name}.png`) });
}

/** The line that says what is shown, once it matches. */
export async function status(page, pattern) {
    const found = await page.waitForFunction(
        (source) => {
            const text = document.querySelector("#status").textContent;
            return new RegExp(source).test(text) && text;
        },
        pattern.source,
        { timeout: 60_000 },
    );
    return found.jsonValue();
}
