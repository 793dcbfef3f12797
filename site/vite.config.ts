// SPDX-License-Identifier: Apache-2.0
// Relative addresses, so that the page works in any folder of any server; nothing is inlined, so that
// the WebAssembly module is compiled while it arrives. The documentation lies beside the page in
// build/site/docs (`make book`), so the folder is not emptied.
import { rmSync } from "node:fs";
import { resolve } from "node:path";
import preact from "@preact/preset-vite";
import { type Plugin, defineConfig } from "vite";

// Scripts of an earlier build have other names.
const withoutOldAssets: Plugin = {
  name: "without-old-assets",
  apply: "build",
  configResolved: ({ root, build }) =>
    rmSync(resolve(root, build.outDir, "assets"), { recursive: true, force: true }),
};

export default defineConfig({
  base: "./",
  plugins: [preact(), withoutOldAssets],
  worker: { format: "es" },
  build: { outDir: "../build/site", emptyOutDir: false, assetsInlineLimit: 0, target: "es2022" },
});
