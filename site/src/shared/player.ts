// SPDX-License-Identifier: Apache-2.0
// The clock of a carry: plays, pauses, steps and scrubs. It stands still while nobody can see it.
import { signal } from "@preact/signals";

export class Player {
  readonly time = signal(0);
  readonly playing = signal(false);
  readonly speed = signal(1);
  readonly frames = signal(0); // drawn so far, for measurements
  end = () => 0; // how long the carry lasts [s]
  onEnd: () => void = () => {};
  isHeld = () => false; // whether it waits for an answer first
  filming = false; // a film goes on where nobody looks
  private visible = true;
  private last = 0;
  private request = 0;

  play(): void {
    if (this.isHeld()) return;
    if (this.time.peek() >= this.end()) this.time.value = 0;
    this.playing.value = true;
    this.next();
  }

  pause(): void {
    this.playing.value = false;
  }

  toggle(): void {
    if (this.playing.peek()) this.pause();
    else this.play();
  }

  seek(time: number): void {
    this.time.value = Math.min(Math.max(time, 0), this.end());
  }

  // What a visitor does by hand.
  scrub(time: number): void {
    this.pause();
    if (!this.isHeld()) this.seek(time);
  }

  step(seconds: number): void {
    this.scrub(Math.round((this.time.peek() + seconds) * 1e6) / 1e6);
  }

  // Stops the clock while the element is outside the window or the window is hidden.
  watch(element: Element): () => void {
    const observer = new IntersectionObserver(([entry]) => {
      this.visible = entry!.isIntersecting;
      this.next();
    });
    const wake = () => this.next();
    observer.observe(element);
    document.addEventListener("visibilitychange", wake);
    return () => {
      observer.disconnect();
      document.removeEventListener("visibilitychange", wake);
      cancelAnimationFrame(this.request);
      this.request = 0;
      this.last = 0;
    };
  }

  private runs(): boolean {
    return this.playing.peek() && (this.visible || this.filming) && !document.hidden;
  }

  private next(): void {
    if (!this.runs()) {
      this.last = 0;
      return;
    }
    if (this.request) return;
    this.request = requestAnimationFrame((now) => {
      this.request = 0;
      const passed = this.last ? Math.min(now - this.last, 100) : 0;
      this.last = now;
      if (!this.runs()) return;
      const time = this.time.peek() + (passed / 1000) * this.speed.peek();
      this.frames.value += 1;
      if (time >= this.end()) {
        this.time.value = this.end();
        this.playing.value = false;
        this.last = 0;
        this.onEnd();
        return;
      }
      this.time.value = time;
      this.next();
    });
  }
}
