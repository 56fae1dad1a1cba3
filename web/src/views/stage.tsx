// The exact frame with boxes, names and the selection's track, as zoomed in to; the pointer on it.
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";

import { forReaders } from "../logic/errors";
import { baseName, formatScore } from "../logic/format";
import { type DrawnSighting, type Fit, boxBetween, drawSightings, drawTrail, hit } from "../logic/overlay";
import * as jobs from "../jobs";
import { objectOf } from "../objects";
import { frameCanvas, pictureVersion, player, unplayable } from "../player";
import { sightingsAt, sightingsVersion, trailOf } from "../sightings";
import * as notices from "../notices";
import * as selection from "../selection";
import * as state from "../state";
import * as zoom from "../zoom";
import { FirstSteps } from "./first_steps";
import { Overview, StageTools } from "./stage_tools";

const TRAIL_FRAMES = 60;
/** px; a shorter drag is a click */
const MIN_DRAG = 4;

export const togglePlay = () => player.togglePlay();

/** Lets the next drag box an object in the frame, or not. */
export function toggleBoxing() {
  if (!state.isBoxing.value && !jobs.canAdd.value) {
    notices.notify(jobs.whyNotAdd(), "error");
    return;
  }
  if (state.isPlaying.value) togglePlay();
  state.isBoxing.value = !state.isBoxing.value;
}

interface Layers {
  drawn: readonly DrawnSighting[];
  trail: readonly [number, number][];
  colour: string;
  frame: number;
}

/** What is drawn over a frame: sightings, and the selection's track. */
function layersOf(frame: number): Layers {
  const selected = state.selectedId.value;
  const matches = state.matcher.value;
  const sightings = [...sightingsAt(frame)].sort(
    (a, b) => Number(a.object_id === selected) - Number(b.object_id === selected),
  );
  const drawn = sightings.map((sighting): DrawnSighting => {
    const object = objectOf(sighting.object_id);
    const name = state.modelName(sighting.model_id);
    const isSelected = sighting.object_id === selected;
    const isRejected = object?.review?.verdict === "rejected";
    const isGreyed = object !== undefined && !matches(object);
    return { sighting, label: name, colour: state.colourOf(name), isSelected, isGreyed, isRejected };
  });
  const chosen = drawn.find((one) => one.isSelected);
  return { drawn, trail: chosen && selected !== null ? trailOf(selected, frame, TRAIL_FRAMES) : [], colour: chosen?.colour ?? "", frame };
}

function drawFrame(context: CanvasRenderingContext2D, at: Fit, layers: Layers | null, width: number) {
  const { width: across, height: down } = zoom.frame.value;
  // Enlarged, a pixel of the video is a square: what is there is seen, and nothing between.
  context.imageSmoothingEnabled = at.scale * (window.devicePixelRatio || 1) < 2;
  context.imageSmoothingQuality = "high";
  context.filter = zoom.filter.value;
  context.drawImage(frameCanvas, at.x, at.y, across * at.scale, down * at.scale);
  context.filter = "none";
  if (layers === null) return;
  drawTrail(context, layers.trail, layers.colour, at);
  drawSightings(context, layers.drawn, { width: across, height: down }, at, width);
}

/** What lies under the pointer, enlarged. */
function drawLens(context: CanvasRenderingContext2D, layers: Layers | null, width: number) {
  const lens = zoom.lens.value;
  if (lens === null) return;
  const [x, y] = lens.point;
  const rim = new Path2D();
  rim.arc(x, y, zoom.LENS_RADIUS, 0, 2 * Math.PI);
  context.save();
  context.fillStyle = "#000";
  context.fill(rim);
  context.save();
  context.clip(rim);
  drawFrame(context, lens.at, layers, width);
  context.restore();
  for (const [lineWidth, colour] of [[5, "rgb(0 0 0 / 65%)"], [2, "#fff"]] as const) {
    context.lineWidth = lineWidth;
    context.strokeStyle = colour;
    context.stroke(rim);
  }
  context.restore();
}

function draw(canvas: HTMLCanvasElement) {
  const context = canvas.getContext("2d");
  const frame = state.shownFrame.value;
  const { width, height } = zoom.area.value;
  const density = window.devicePixelRatio || 1;
  if (!context) return;
  if (canvas.width !== Math.round(width * density)) canvas.width = Math.round(width * density);
  if (canvas.height !== Math.round(height * density)) canvas.height = Math.round(height * density);
  context.setTransform(density, 0, 0, density, 0, 0);
  context.clearRect(0, 0, width, height);
  if (frame === null) return;
  const at = zoom.at.value;
  const layers = state.isOverlayHidden.value ? null : layersOf(frame);
  drawFrame(context, at, layers, width);
  drawLens(context, layers, width);
  canvas.dataset["frame"] = String(frame);
  canvas.dataset["place"] = [at.x, at.y, at.scale].map((one) => one.toFixed(4)).join(" ");
}

/** What lies under a point of the area that shows the frame; under the lens, what it shows there. */
function sightingUnder(x: number, y: number) {
  const frame = state.shownFrame.value;
  if (frame === null) return null;
  const at = zoom.at.value;
  return hit(sightingsAt(frame), (x - at.x) / at.scale, (y - at.y) / at.scale);
}

/** Says what is under the pointer. The score is that of one frame, not that of the object in the list. */
function explain(target: HTMLCanvasElement, x: number, y: number) {
  const found = sightingUnder(x, y);
  const how = found?.source === "tracked" ? "tracked to this frame" : "recognised in this frame";
  target.title = found ? `${state.modelName(found.model_id)} ${found.object_id}: ${how}, score of the frame ${formatScore(found.score)}` : "";
}

/** Drags the frame while it is zoomed in, by one pointer; two fingers zoom. */
function usePan(canvas: { current: HTMLCanvasElement | null }) {
  const pointers = useRef(new Map<number, readonly [number, number]>());
  const start = useRef<readonly [number, number] | null>(null);
  const isMoved = useRef(false);
  const begin = (event: PointerEvent) => {
    if (event.button !== 0 && event.button !== 1) return;
    if (event.button === 1) event.preventDefault();
    if (pointers.current.size === 0) isMoved.current = false;
    pointers.current.set(event.pointerId, [event.offsetX, event.offsetY]);
    start.current = [event.offsetX, event.offsetY];
  };
  /** Returns whether the frame is dragged. */
  const move = (event: PointerEvent): boolean => {
    const before = pointers.current.get(event.pointerId);
    if (before === undefined) return false;
    const [x, y] = [event.offsetX, event.offsetY];
    const from = start.current ?? before;
    if (!isMoved.current && pointers.current.size === 1 && Math.hypot(x - from[0], y - from[1]) < MIN_DRAG) return false;
    const other = [...pointers.current].find(([id]) => id !== event.pointerId)?.[1];
    pointers.current.set(event.pointerId, [x, y]);
    if (zoom.zoom.peek() === null && other === undefined) return false;
    isMoved.current = true;
    if (other === undefined) zoom.pan(x - before[0], y - before[1]);
    else {
      zoom.pan((x - before[0]) / 2, (y - before[1]) / 2);
      const [far, near] = [Math.hypot(x - other[0], y - other[1]), Math.hypot(before[0] - other[0], before[1] - other[1])];
      if (near > 1) zoom.zoomAt([(x + other[0]) / 2, (y + other[1]) / 2], far / near);
    }
    if (canvas.current) canvas.current.title = "";
    return true;
  };
  const end = (event: PointerEvent) => {
    pointers.current.delete(event.pointerId);
  };
  return { begin, move, end, hasMoved: () => isMoved.current };
}

/** While the frame is zoomed in, an object that is selected is brought into view once the frame shows it. */
function useRecentring() {
  useEffect(() => {
    let waiting: number | null = null;
    let known = state.selectedId.peek();
    return effect(() => {
      const [id, frame] = [state.selectedId.value, state.shownFrame.value];
      void sightingsVersion.value;
      if (id !== known) waiting = id;
      known = id;
      const sighting = waiting === null || frame === null ? undefined : sightingsAt(frame).find((one) => one.object_id === waiting);
      if (!sighting) return;
      waiting = null;
      zoom.bringIntoView(sighting.box);
    });
  }, []);
}

/** Zooms in to the selected object, where the frame shows it. */
export function zoomToSelected() {
  const [id, frame] = [state.selectedId.value, state.shownFrame.value];
  const sighting = frame === null ? undefined : sightingsAt(frame).find((one) => one.object_id === id);
  if (sighting) zoom.showBox(sighting.box);
  else notices.notify("This frame does not show the selected object: L goes to where it was seen.");
}

export function Stage() {
  const element = useRef<HTMLVideoElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (!element.current || !canvas.current) return;
    const shown = canvas.current;
    player.attach(element.current);
    let scheduled = 0;
    const redraw = () => {
      scheduled ||= requestAnimationFrame(() => {
        scheduled = 0;
        draw(shown);
      });
    };
    const stop = effect(() => {
      // Draws at once: in the callback of the frame, and with the overlay of that frame.
      void pictureVersion.value;
      void sightingsVersion.value;
      draw(shown);
    });
    const measure = () => {
      zoom.area.value = { width: shown.clientWidth, height: shown.clientHeight };
      redraw();
    };
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(shown);
    return () => {
      stop();
      observer.disconnect();
    };
  }, []);
  useRecentring();
  const pan = usePan(canvas);
  const [drag, setDrag] = useState<{ from: [number, number]; to: [number, number] } | null>(null);
  const isBoxing = state.isBoxing.value;
  const begin = (event: PointerEvent) => {
    canvas.current?.setPointerCapture(event.pointerId);
    if (isBoxing && event.button === 0) setDrag({ from: [event.offsetX, event.offsetY], to: [event.offsetX, event.offsetY] });
    else pan.begin(event);
  };
  const move = (event: PointerEvent) => {
    zoom.pointer.value = [event.offsetX, event.offsetY];
    if (drag) setDrag({ from: drag.from, to: [event.offsetX, event.offsetY] });
    else if (!pan.move(event) && canvas.current) explain(canvas.current, event.offsetX, event.offsetY);
  };
  const end = (event: PointerEvent) => {
    pan.end(event);
    const [frame, video] = [state.shownFrame.value, state.video.value];
    setDrag(null);
    if (!drag || frame === null || !video) return;
    const box = boxBetween(drag.from, [event.offsetX, event.offsetY], zoom.frame.value, zoom.at.value);
    if (box === null) {
      notices.notify("The box is too small: draw it around the whole object.", "error");
      return;
    }
    state.isBoxing.value = false;
    jobs.askedModel.value = { video: video.id, frame, box };
  };
  const click = (event: MouseEvent) => {
    if (isBoxing || jobs.askedModel.value !== null || pan.hasMoved()) return;
    const found = sightingUnder(event.offsetX, event.offsetY);
    if (found) return selection.select(found.object_id, { seek: false, push: true });
    togglePlay();
  };
  const video = state.video.value;
  const table = state.frameTable.value;
  const behind = jobs.behind.value;
  const problem = (video?.missing ? forReaders(video.missing) : null) ?? (table.state === "failed" ? table.message : null);
  return (
    <div class="stage">
      <video ref={element} muted playsInline preload="auto" tabIndex={-1} aria-hidden="true" />
      <canvas
        ref={canvas}
        role="img"
        aria-label="The frame that is shown, with what was found in it"
        class={isBoxing ? "boxing" : zoom.zoom.value !== null ? "zoomed" : ""}
        onClick={click}
        onPointerDown={begin}
        onPointerMove={move}
        onPointerUp={end}
        onPointerCancel={(event) => {
          pan.end(event);
          setDrag(null);
        }}
        onPointerLeave={() => (zoom.pointer.value = null)}
        onWheel={(event) => {
          // Where the page itself scrolls, the wheel does so.
          const doesScroll = document.documentElement.scrollHeight > window.innerHeight + 1 && !zoom.isFull.value;
          if (drag !== null || (doesScroll && !event.ctrlKey)) return;
          event.preventDefault();
          const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1;
          zoom.zoomAt([event.offsetX, event.offsetY], Math.exp((-event.deltaY * lines) / (event.ctrlKey ? 100 : 400)));
        }}
      />
      {drag && (
        <div
          class="drawn-box"
          style={{
            left: Math.min(drag.from[0], drag.to[0]),
            top: Math.min(drag.from[1], drag.to[1]),
            width: Math.abs(drag.to[0] - drag.from[0]),
            height: Math.abs(drag.to[1] - drag.from[1]),
          }}
        />
      )}
      {isBoxing && !drag && <div class="message">Draw a box around the object. B or Esc leaves.</div>}
      {!problem && state.shownFrame.value !== null && <StageTools />}
      {!problem && <Overview />}
      {video && (!problem || behind !== null) && (
        <div class="corner" title={video.name}>
          <span>{baseName(video.name)}</span>
          {behind !== null && (
            <span class="behind" title="What was filmed since then is not searched yet">
              {behind}
            </span>
          )}
        </div>
      )}
      {problem && (
        <div class="message middle" role="alert">
          {problem}
        </div>
      )}
      {!problem && unplayable.value && <div class="message">{unplayable.value}</div>}
      {!problem && video && state.shownFrame.value === null && <div class="message middle">Loading the video</div>}
      {state.project.value.state === "ready" && state.project.value.value.videos === 0 && (
        jobs.canAdd.value ? <FirstSteps /> : <div class="message middle">There is no video in this index.</div>
      )}
    </div>
  );
}

