/** Questions and answers as bytes; the Rust side is crates/keyway-web/src/message.rs. */

export type Parts = Record<string, Uint8Array>;

export interface Message {
    head: string;
    parts: Parts;
}

export function toBytes(message: Message): Uint8Array {
    const encoder = new TextEncoder();
    const texts: Uint8Array[] = [encoder.encode(message.head)];
    for (const [name, bytes] of Object.entries(message.parts)) {
        texts.push(encoder.encode(name), bytes);
    }
    const length = texts.reduce((sum, text) => sum + 4 + text.length, 0);
    const all = new Uint8Array(length);
    const view = new DataView(all.buffer);
    let at = 0;
    for (const text of texts) {
        view.setUint32(at, text.length, true);
        all.set(text, at + 4);
        at += 4 + text.length;
    }
    return all;
}

export function fromBytes(bytes: Uint8Array): Message {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = 0;
    const next = () => {
        const length = view.getUint32(at, true);
        const content = bytes.slice(at + 4, at + 4 + length);
        at += 4 + length;
        return content;
    };
    const text = () => new TextDecoder().decode(next());
    const message: Message = { head: text(), parts: {} };
    while (at < bytes.length) {
        const name = text();
        message.parts[name] = next();
    }
    return message;
}

/** Numbers of a part, which begins where the bytes were allocated. */
export const integers = (part: Uint8Array | undefined) =>
    part ? new Int32Array(part.buffer, part.byteOffset, part.byteLength / 4) : new Int32Array();
export const singles = (part: Uint8Array | undefined) =>
    part ? new Float32Array(part.buffer, part.byteOffset, part.byteLength / 4) : new Float32Array();
export const doubles = (part: Uint8Array | undefined) =>
    part ? new Float64Array(part.buffer, part.byteOffset, part.byteLength / 8) : new Float64Array();
