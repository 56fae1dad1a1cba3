// Draws a frame and what was found in it.
import type { Sighting } from "../api/types";

export interface Fit {
  x: number;
  y: number;
  scale: number;
}

/** Places a picture in an area, whole and centred. */
export function fit(width: number, height: number, areaWidth: number, areaHeight: number): Fit {
  const scale = Math.min(areaWidth / Math.max(width, 1), areaHeight / Math.max(height, 1));
  return { scale, x: (areaWidth - width * scale) / 2, y: (areaHeight - height * scale) / 2 };
}

export interface DrawnSighting {
  sighting: Pick<Sighting, "box" | "outline" | "source">;
  label: string;
  colour: string;
  isSelected: boolean;
  isGreyed: boolean;
  /** Rejected by a person: drawn dashed. */
  isRejected: boolean;
}

/** px; smaller objects have no features. */
const MIN_BOX = 12;

/** The sighting whose box holds a point of the frame; of several the smallest. */
export function hit(sightings: readonly Sighting[], x: number, y: number): Sighting | null {
  let best: Sighting | null = null;
  const area = (one: Sighting) => (one.box[2] ?? 0) * (one.box[3] ?? 0);
  for (const one of sightings) {
    const [left = 0, top = 0, width = 0, height = 0] = one.box;
    const isInside = x >= left && y >= top && x < left + width && y < top + height;
    if (isInside && (best === null || area(one) < area(best))) best = one;
  }
  return best;
}

/**
 * The box between two points of the area, in the picture's pixels and inside the picture; null: it is too small to hold
 * an object.
 */
export function boxBetween(from: readonly number[], to: readonly number[], frame: { width: number; height: number }, at: Fit) {
  const [fromX = 0, fromY = 0] = from;
  const [toX = 0, toY = 0] = to;
  const inside = (value: number, offset: number, side: number) => Math.min(Math.max((value - offset) / at.scale, 0), side);
  const [x1, x2] = [inside(fromX, at.x, frame.width), inside(toX, at.x, frame.width)];
  const [y1, y2] = [inside(fromY, at.y, frame.height), inside(toY, at.y, frame.height)];
  const box = [Math.min(x1, x2), Math.min(y1, y2), Math.abs(x2 - x1), Math.abs(y2 - y1)].map(Math.round);
  return Math.min(box[2] ?? 0, box[3] ?? 0) < MIN_BOX ? null : box;
}

function tracePath(context: CanvasRenderingContext2D, points: readonly (readonly number[])[], at: Fit, close: boolean) {
  context.beginPath();
  points.forEach(([x = 0, y = 0], i) => {
    const [px, py] = [at.x + x * at.scale, at.y + y * at.scale];
    if (i === 0) context.moveTo(px, py);
    else context.lineTo(px, py);
  });
  if (close) context.closePath();
}

function cornersOf(sighting: DrawnSighting["sighting"]): number[][] {
  if (sighting.outline.length > 2) return sighting.outline;
  const [x = 0, y = 0, width = 0, height = 0] = sighting.box;
  return [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
}

const opacityOf = (one: DrawnSighting) => (one.isGreyed && !one.isSelected ? 0.35 : 1);

/**
 * Draws all outlines, then all labels: no line strikes out a name. Sizes in CSS pixels: lines and letters keep their size at
 * any zoom of the frame.
 */
export function drawSightings(
  context: CanvasRenderingContext2D,
  all: readonly DrawnSighting[],
  frame: { width: number; height: number },
  at: Fit,
  areaWidth: number,
) {
  for (const one of all) drawOutline(context, one, frame, at);
  for (const one of all) drawLabel(context, one, at, areaWidth);
}

function drawOutline(context: CanvasRenderingContext2D, one: DrawnSighting, frame: { width: number; height: number }, at: Fit) {
  const { sighting, colour } = one;
  context.save();
  context.globalAlpha = opacityOf(one);
  context.lineJoin = "round";
  context.beginPath();
  context.rect(at.x, at.y, frame.width * at.scale, frame.height * at.scale);
  context.clip();
  context.setLineDash(one.isRejected ? [5, 4] : sighting.source === "tracked" ? [9, 3] : []);
  tracePath(context, cornersOf(sighting), at, true);
  context.lineWidth = one.isSelected ? 5 : 3.5;
  context.strokeStyle = "rgb(0 0 0 / 65%)";
  context.stroke();
  context.lineWidth = one.isSelected ? 2.5 : 1.5;
  context.strokeStyle = colour;
  context.stroke();
  context.restore();
}

function drawLabel(context: CanvasRenderingContext2D, one: DrawnSighting, at: Fit, areaWidth: number) {
  const { sighting, colour } = one;
  context.save();
  context.globalAlpha = opacityOf(one);
  const [x = 0, y = 0, , height = 0] = sighting.box;
  const text = one.label;
  context.font = `${one.isSelected ? 600 : 400} 12px system-ui, sans-serif`;
  const width = context.measureText(text).width + 10;
  const left = Math.min(Math.max(at.x + x * at.scale, 2), areaWidth - width - 2);
  const above = at.y + y * at.scale - 22;
  const bottom = at.y + (y + height) * at.scale;
  const top = above > 2 ? above : bottom + 4;
  context.fillStyle = one.isSelected ? colour : "rgb(0 0 0 / 70%)";
  context.beginPath();
  context.roundRect(left, top, width, 18, 3);
  context.fill();
  context.fillStyle = one.isSelected ? "#101010" : "#ffffff";
  context.fillText(text, left + 5, top + 13);
  context.restore();
}

/** The centres of an object's boxes in this frame and those before it, oldest first; frames without a box are left out. */
export function boxCentres(frame: number, frames: number, boxAt: (frame: number) => readonly number[] | undefined) {
  const centres: [number, number][] = [];
  for (let at = Math.max(0, frame - frames); at <= frame; at++) {
    const box = boxAt(at);
    if (!box) continue;
    const [x = 0, y = 0, width = 0, height = 0] = box;
    centres.push([x + width / 2, y + height / 2]);
  }
  return centres;
}

export function drawTrail(context: CanvasRenderingContext2D, trail: readonly [number, number][], colour: string, at: Fit) {
  if (trail.length < 2) return;
  context.save();
  context.lineWidth = 2;
  context.strokeStyle = colour;
  context.globalAlpha = 0.8;
  context.setLineDash([2, 4]);
  context.lineCap = "round";
  tracePath(context, trail, at, false);
  context.stroke();
  context.restore();
}
