/** Links that hold the state of the page, and its own files where they are small enough. */

import { fromBytes, toBytes, type Parts } from "./engine/message";
import { checked, type State } from "./state";

/** Browsers take addresses of about two million letters; larger files are not packed at all. */
const MOST_LETTERS = 1_000_000;
const MOST_BYTES = 1 << 24;

async function through(bytes: Uint8Array, stream: TransformStream): Promise<Uint8Array> {
    const body = new Blob([bytes as BlobPart]).stream().pipeThrough(stream);
    return new Uint8Array(await new Response(body).arrayBuffer());
}

async function packed(bytes: Uint8Array): Promise<string> {
    const small = await through(bytes, new CompressionStream("deflate-raw"));
    const letters = btoa(Array.from(small, (byte) => String.fromCharCode(byte)).join(""));
    return letters.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** The fragment of an address: the state as JSON, and behind a zero byte the files, if any. */
export async function toFragment(
    state: State,
    files: Parts,
): Promise<{ fragment: string; isWhole: boolean }> {
    const text = new TextEncoder().encode(JSON.stringify(state));
    const sizes = Object.values(files).map((file) => file.length);
    if (sizes.length > 0 && sizes.reduce((a, b) => a + b) <= MOST_BYTES) {
        const parts = toBytes({ head: "", parts: files });
        const bytes = new Uint8Array(text.length + 1 + parts.length);
        bytes.set(text);
        bytes.set(parts, text.length + 1);
        const fragment = await packed(bytes);
        if (fragment.length <= MOST_LETTERS) return { fragment, isWhole: true };
    }
    return { fragment: await packed(text), isWhole: sizes.length === 0 };
}

/** The state and the files of a fragment, as far as they can be read. */
export async function fromFragment(fragment: string): Promise<{ state: State; files: Parts }> {
    try {
        const letters = atob(fragment.replaceAll("-", "+").replaceAll("_", "/"));
        const small = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
        const bytes = await through(small, new DecompressionStream("deflate-raw"));
        const zero = bytes.indexOf(0);
        const text = zero < 0 ? bytes : bytes.subarray(0, zero);
        const files = zero < 0 ? {} : fromBytes(bytes.slice(zero + 1)).parts;
        return { state: checked(JSON.parse(new TextDecoder().decode(text))), files };
    } catch {
        return { state: checked(null), files: {} };
    }
}
