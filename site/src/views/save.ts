// SPDX-License-Identifier: Apache-2.0
// Saves what a canvas shows, as a picture or as a film of the rest of the carry.
import { download } from "./parts";
import { player } from "../shared/state";
import { palette } from "../shared/theme";

const FILM_S = 12; // at most, in real time

// The canvas on the page's background: its own is transparent.
function opaque(canvas: HTMLCanvasElement): HTMLCanvasElement {
  const copy = document.createElement("canvas");
  copy.width = canvas.width;
  copy.height = canvas.height;
  paint(canvas, copy);
  return copy;
}

function paint(from: HTMLCanvasElement, to: HTMLCanvasElement): void {
  const context = to.getContext("2d")!;
  context.fillStyle = palette.value.background;
  context.fillRect(0, 0, to.width, to.height);
  context.drawImage(from, 0, 0);
}

function canvasOf(id: string): HTMLCanvasElement {
  return document.getElementById(id) as HTMLCanvasElement;
}

export async function savePicture(id: string): Promise<void> {
  const blob = await new Promise<Blob | null>((done) => opaque(canvasOf(id)).toBlob(done));
  if (blob) download("palmbots.png", blob);
}

// Plays on from the present moment, at the chosen speed, and saves the film when the carry ends.
export async function saveFilm(id: string): Promise<void> {
  const canvas = canvasOf(id);
  const copy = opaque(canvas);
  const kind = ["video/webm;codecs=vp9", "video/webm", "video/mp4"].find((type) =>
    MediaRecorder.isTypeSupported(type),
  );
  const recorder = new MediaRecorder(copy.captureStream(30), kind ? { mimeType: kind } : undefined);
  const parts: Blob[] = [];
  recorder.ondataavailable = (event) => parts.push(event.data);
  const stopped = new Promise((done) => (recorder.onstop = done));
  recorder.start();
  player.filming = true;
  player.play();
  const began = performance.now();
  await new Promise<void>((done) => {
    const frame = () => {
      paint(canvas, copy);
      const late = performance.now() - began > 1000 * FILM_S;
      if (late || !player.playing.peek()) done();
      else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  player.pause();
  player.filming = false;
  recorder.stop();
  await stopped;
  const suffix = recorder.mimeType.includes("mp4") ? "mp4" : "webm";
  download(`palmbots.${suffix}`, new Blob(parts, { type: recorder.mimeType }));
}
