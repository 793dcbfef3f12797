// SPDX-License-Identifier: Apache-2.0
// Whether an outline can rest on its contact vertices, with exact predicates as in the package's
// geometry of polygons: no tolerance decides whether an outline crosses itself.

export type Point = readonly [number, number];

// A number as a multiple of 2⁻¹⁰⁷⁴, without rounding.
function exact(x: number): bigint {
  const bits = new DataView(new ArrayBuffer(8));
  bits.setFloat64(0, x);
  const high = bits.getUint32(0);
  const exponent = (high >>> 20) & 0x7ff;
  const digits = (BigInt(high & 0xfffff) << 32n) | BigInt(bits.getUint32(4));
  const size = exponent ? (digits | (1n << 52n)) << BigInt(exponent - 1) : digits;
  return high >>> 31 ? -size : size;
}

// The sign of (q − p) × (s − r).
function signOfCross(p: Point, q: Point, r: Point, s: Point): number {
  const one = (q[0] - p[0]) * (s[1] - r[1]);
  const two = (q[1] - p[1]) * (s[0] - r[0]);
  // Beyond this size, rounding cannot change the sign.
  if (Math.abs(one - two) > 1e-15 * (Math.abs(one) + Math.abs(two)) + 1e-300) {
    return Math.sign(one - two);
  }
  const between = (a: Point, b: Point, k: 0 | 1) => exact(b[k]) - exact(a[k]);
  const cross = between(p, q, 0) * between(r, s, 1) - between(p, q, 1) * between(r, s, 0);
  return cross > 0n ? 1 : cross < 0n ? -1 : 0;
}

// The sign of (q − p) · (s − r).
const signOfDot = (p: Point, q: Point, r: Point, s: Point) =>
  signOfCross(p, q, [-r[1], r[0]], [-s[1], s[0]]);
const turn = (a: Point, b: Point, c: Point) => signOfCross(a, b, a, c);

function isOnSegment(point: Point, a: Point, b: Point): boolean {
  return ([0, 1] as const).every(
    (k) => Math.min(a[k], b[k]) <= point[k] && point[k] <= Math.max(a[k], b[k]),
  );
}

function meet(a: Point, b: Point, c: Point, d: Point): boolean {
  const [abc, abd, cda, cdb] = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
  if (abc !== abd && cda !== cdb && abc && abd && cda && cdb) return true;
  return (
    (abc === 0 && isOnSegment(c, a, b)) || (abd === 0 && isOnSegment(d, a, b)) ||
    (cda === 0 && isOnSegment(a, c, d)) || (cdb === 0 && isOnSegment(b, c, d))
  );
}

// The first two edges that keep an outline from being simple; twice the same one if it has no length.
export function crossingEdges(outline: Point[]): [number, number] | null {
  const end = (k: number) => outline[(k + 1) % outline.length]!;
  const short = outline.findIndex((a, k) => a[0] === end(k)[0] && a[1] === end(k)[1]);
  if (short >= 0) return [short, short];
  const last = outline.length - 1;
  for (let i = 0; i <= last; ++i) {
    const [a, b] = [outline[i]!, end(i)];
    for (let j = i + 1; j <= last; ++j) {
      const [c, d] = [outline[j]!, end(j)];
      const bad =
        j === i + 1 ? turn(a, b, d) === 0 && signOfDot(a, b, c, d) < 0
        : i === 0 && j === last ? turn(c, d, b) === 0 && signOfDot(c, d, a, b) < 0
        : meet(a, b, c, d);
      if (bad) return [i, j];
    }
  }
  return null;
}

// The corners of the convex hull as indices, counter-clockwise.
export function hull(points: Point[]): number[] {
  const order = points
    .map((_, k) => k)
    .sort((i, j) => points[i]![0] - points[j]![0] || points[i]![1] - points[j]![1]);
  const chain = (indices: number[]) => {
    const corners: number[] = [];
    for (const i of indices) {
      while (
        corners.length > 1 &&
        turn(points[corners.at(-2)!]!, points[corners.at(-1)!]!, points[i]!) <= 0
      ) {
        corners.pop();
      }
      corners.push(i);
    }
    return corners.slice(0, -1);
  };
  return [...chain(order), ...chain([...order].reverse())];
}

// Whether a point lies in the convex hull of an outline or on its boundary.
export function isInHull(point: Point, outline: Point[]): boolean {
  const corners = hull(outline).map((k) => outline[k]!);
  return corners.every((a, k) => turn(a, corners[(k + 1) % corners.length]!, point) >= 0);
}

// The vertices at which an outline can rest on a level floor, turned so that the contacts are level.
export function lowerVertices(outline: Point[], left: number, right: number): Set<number> {
  const corners = hull(outline);
  const ends = new Set<number>();
  corners.forEach((i, k) => {
    const next = corners[(k + 1) % corners.length]!;
    // Counter-clockwise, a side with the interior above it runs from left to right.
    if (signOfDot(outline[i]!, outline[next]!, outline[left]!, outline[right]!) > 0) {
      ends.add(i);
      ends.add(next);
    }
  });
  return ends;
}

// The area of a simple outline, and its centroid.
export function areaAndCentroid(outline: Point[]): [number, Point] {
  const [ox, oy] = outline[0]!; // seen from the first vertex: no digits are lost far from the origin
  let area = 0;
  let mx = 0;
  let my = 0;
  outline.forEach((v, k) => {
    const next = outline[(k + 1) % outline.length]!;
    const [ax, ay, bx, by] = [v[0] - ox, v[1] - oy, next[0] - ox, next[1] - oy];
    const cross = ax * by - bx * ay;
    area += cross / 2;
    mx += (cross * (ax + bx)) / 6;
    my += (cross * (ay + by)) / 6;
  });
  return [Math.abs(area), [ox + mx / area, oy + my / area]];
}
