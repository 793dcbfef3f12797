// SPDX-License-Identifier: Apache-2.0
// The worker of the page that is one file: the script of the page again, from memory.
export function startWorker(): Worker {
  const script = document.getElementById("page")!.textContent!;
  return new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
}
