// SPDX-License-Identifier: Apache-2.0
// Relative addresses, so that the page works in any folder of any server; nothing is inlined, so that
// the WebAssembly module is compiled while it arrives. The documentation, if it has been built, lies
// beside the page in build/site/docs, so the folder is not emptied.
import { existsSync, rmSync } from "node:fs";
import preact from "@preact/preset-vite";
import { defineConfig } from "vite";

const OUT = "../build/site";

export default defineConfig(({ command }) => {
  if (command === "build") rmSync(`${OUT}/assets`, { recursive: true, force: true });
  return {
    base: "./",
    plugins: [preact()],
    worker: { format: "es" },
    define: { __HAS_DOCS__: String(existsSync(`${OUT}/docs/index.html`)) },
    build: { outDir: OUT, emptyOutDir: false, assetsInlineLimit: 0, target: "es2022" },
  };
});
