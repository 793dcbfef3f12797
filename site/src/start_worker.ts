// SPDX-License-Identifier: Apache-2.0
// The worker of the site.
export function startWorker(): Worker {
  return new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
}
