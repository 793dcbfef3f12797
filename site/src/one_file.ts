// SPDX-License-Identifier: Apache-2.0
// The page as one file, whose script is the page's and its worker's (vite.config.ts).
if ("document" in globalThis) void import("./main");
else void import("./worker");
