import { defineConfig } from "vite";

// Addresses are relative, so that the page works in any folder of any host. Maps and scenes are
// loaded when they are asked for.
export default defineConfig({
    base: "./",
    build: { target: "es2022", assetsInlineLimit: 0 },
    worker: { format: "es" },
});
