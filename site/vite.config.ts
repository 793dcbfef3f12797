// SPDX-License-Identifier: Apache-2.0
// The site: relative addresses, so that the page works in any folder of any server; nothing is
// inlined, so that the WebAssembly module is compiled while it arrives. The documentation lies beside
// the page in build/site/docs (`make book`), so the folder is not emptied.
// With `--mode file`: the same page as one file, palmbots.html, which a browser opens without a server.
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import preact from "@preact/preset-vite";
import { type Plugin, type ResolvedConfig, defineConfig } from "vite";

const outputOf = ({ root, build }: ResolvedConfig) => resolve(root, build.outDir);

// Scripts of an earlier build have other names.
const withoutOldAssets: Plugin = {
  name: "without-old-assets",
  apply: "build",
  configResolved: (config) =>
    rmSync(resolve(outputOf(config), "assets"), { recursive: true, force: true }),
};

// Until the book is built, its link leads to a page that says how to build it.
const placeOfBook: Plugin = {
  name: "place-of-book",
  apply: "build",
  configResolved: (config) => {
    const folder = resolve(outputOf(config), "docs");
    if (existsSync(resolve(folder, "index.html"))) return;
    mkdirSync(folder, { recursive: true });
    writeFileSync(
      resolve(folder, "index.html"),
      readFileSync(resolve(config.root, "no_book.html"), "utf-8"),
    );
  },
};

// Puts script, style and icon into index.html. Without JavaScript there is one line in place of the
// pictures.
const asOneFile: Plugin = {
  name: "as-one-file",
  enforce: "post",
  generateBundle(_, bundle) {
    let [script, style] = ["", ""];
    for (const [name, part] of Object.entries(bundle)) {
      if (part.type === "chunk") script += part.code;
      else if (name.endsWith(".css")) style += part.source;
      delete bundle[name];
    }
    const icon = readFileSync("public/icon.svg").toString("base64");
    const source = readFileSync("index.html", "utf-8")
      .replace(/<noscript>[\s\S]*<\/noscript>/, "<noscript>This page needs JavaScript.</noscript>")
      .replace(/<script id="no-server">[\s\S]*?<\/script>\s*/, "")
      .replace('href="/icon.svg"', () => `href="data:image/svg+xml;base64,${icon}"`)
      .replace("</head>", () => `<style>${style}</style>\n  </head>`)
      .replace(/<script type="module".*<\/script>/, () =>
        `<script id="page">${script.replaceAll("</script", "<\\/script")}</script>`);
    this.emitFile({ type: "asset", fileName: "palmbots.html", source });
  },
};

export default defineConfig(({ mode }) => {
  const common = { outDir: "../build/site", emptyOutDir: false, target: "es2022" };
  if (mode !== "file") {
    return {
      base: "./",
      plugins: [preact(), withoutOldAssets, placeOfBook],
      worker: { format: "es" },
      build: { ...common, assetsInlineLimit: 0 },
    };
  }
  return {
    plugins: [preact(), asOneFile],
    publicDir: false,
    resolve: { alias: [{ find: /^.*\/start_worker$/, replacement: resolve("src/start_worker_of_file.ts") }] },
    build: {
      ...common,
      assetsInlineLimit: Number.MAX_SAFE_INTEGER,
      cssCodeSplit: false,
      modulePreload: false,
      chunkSizeWarningLimit: 2000,
      rolldownOptions: {
        input: "src/one_file.ts",
        output: { format: "iife", codeSplitting: false },
        transform: { define: { "import.meta": "{}" } },
      },
    },
  };
});
