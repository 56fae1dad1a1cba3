// The video: the exact frame with boxes, names and the selection's track; controls; time line.
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";

import { followed } from "../followed";
import { forReaders } from "../logic/errors";
import { baseName, formatScore, formatTime } from "../logic/format";
import { type DrawnSighting, type Fit, boxBetween, boxCentres, drawSightings, drawTrail, fit, hit } from "../logic/overlay";
import * as jobs from "../jobs";
import { objectOf } from "../objects";
import { frameCanvas, pictureVersion, playbackRate, player, unplayable } from "../player";
import { sightingsAt, sightingsVersion, trailOf } from "../sightings";
import * as notices from "../notices";
import * as selection from "../selection";
import * as state from "../state";
import { FirstSteps } from "./first_steps";
import { Icon } from "./icons";
import { Timeline } from "./timeline";

const TRAIL_FRAMES = 60;

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

function draw(canvas: HTMLCanvasElement) {
  const context = canvas.getContext("2d");
  const frame = state.shownFrame.value;
  const { clientWidth: width, clientHeight: height } = canvas;
  const density = window.devicePixelRatio || 1;
  if (!context) return;
  if (canvas.width !== Math.round(width * density)) canvas.width = Math.round(width * density);
  if (canvas.height !== Math.round(height * density)) canvas.height = Math.round(height * density);
  context.setTransform(density, 0, 0, density, 0, 0);
  context.clearRect(0, 0, width, height);
  if (frame === null) return;
  // Sightings are in the pixels of the video as indexed, which a browser may deliver in another size.
  const video = state.video.value;
  const [videoWidth, videoHeight] = [video?.width_px ?? frameCanvas.width, video?.height_px ?? frameCanvas.height];
  const at = fit(videoWidth, videoHeight, width, height);
  context.drawImage(frameCanvas, at.x, at.y, videoWidth * at.scale, videoHeight * at.scale);
  canvas.dataset["frame"] = String(frame);
  if (state.isOverlayHidden.value) return;
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
  if (chosen && selected !== null) drawTrail(context, trailOf(selected, frame, TRAIL_FRAMES), chosen.colour, at);
  drawn.push(...followedIn(context, frame, at));
  drawSightings(context, drawn, { width: videoWidth, height: videoHeight }, at, width);
}

/** What a user boxed and had followed; draws its trails. */
function followedIn(context: CanvasRenderingContext2D, frame: number, at: Fit): DrawnSighting[] {
  return followed.value.flatMap((one) => {
    const row = one.byFrame.get(frame);
    if (!row) return [];
    const trail = boxCentres(frame, TRAIL_FRAMES, (before) => one.byFrame.get(before)?.box);
    drawTrail(context, trail, state.FOLLOWED_COLOUR, at);
    const sighting = { box: [...row.box], outline: [], source: "recognised" as const };
    return { sighting, label: one.name, isLabelInside: true, colour: state.FOLLOWED_COLOUR, isSelected: false, isGreyed: false, isRejected: false };
  });
}

/** What lies under a point of the area that shows the frame. */
function sightingUnder(target: HTMLCanvasElement, x: number, y: number) {
  const [frame, video] = [state.shownFrame.value, state.video.value];
  if (frame === null || !video) return null;
  const at = fit(video.width_px, video.height_px, target.clientWidth, target.clientHeight);
  return hit(sightingsAt(frame), (x - at.x) / at.scale, (y - at.y) / at.scale);
}

/** Says what is under the pointer. The score is that of one frame, not that of the object in the list. */
function explain(target: HTMLCanvasElement, x: number, y: number) {
  const found = sightingUnder(target, x, y);
  const how = found?.source === "tracked" ? "tracked to this frame" : "recognised in this frame";
  target.title = found ? `${state.modelName(found.model_id)} ${found.object_id}: ${how}, score of the frame ${formatScore(found.score)}` : "";
}

function Stage() {
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
      void followed.value;
      draw(shown);
    });
    const observer = new ResizeObserver(redraw);
    observer.observe(shown);
    return () => {
      stop();
      observer.disconnect();
    };
  }, []);
  const [drag, setDrag] = useState<{ from: [number, number]; to: [number, number] } | null>(null);
  const isBoxing = state.isBoxing.value;
  const begin = (event: PointerEvent) => {
    if (!isBoxing || event.button !== 0) return;
    canvas.current?.setPointerCapture(event.pointerId);
    setDrag({ from: [event.offsetX, event.offsetY], to: [event.offsetX, event.offsetY] });
  };
  const move = (event: PointerEvent) => {
    if (drag) setDrag({ from: drag.from, to: [event.offsetX, event.offsetY] });
    else if (canvas.current) explain(canvas.current, event.offsetX, event.offsetY);
  };
  const end = (event: PointerEvent) => {
    const [frame, video, target] = [state.shownFrame.value, state.video.value, canvas.current];
    setDrag(null);
    if (!drag || frame === null || !video || !target) return;
    const size = { width: video.width_px, height: video.height_px };
    const at = fit(size.width, size.height, target.clientWidth, target.clientHeight);
    const box = boxBetween(drag.from, [event.offsetX, event.offsetY], size, at);
    if (box === null) {
      notices.notify("The box is too small: draw it around the whole object.", "error");
      return;
    }
    state.isBoxing.value = false;
    jobs.askedModel.value = { video: video.id, frame, box };
  };
  const click = (event: MouseEvent) => {
    if (isBoxing || jobs.askedModel.value !== null) return;
    const found = canvas.current && sightingUnder(canvas.current, event.offsetX, event.offsetY);
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
        class={isBoxing ? "boxing" : ""}
        onClick={click}
        onPointerDown={begin}
        onPointerMove={move}
        onPointerUp={end}
        onPointerCancel={() => setDrag(null)}
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

function Controls() {
  const frame = state.shownFrame.value;
  const time = state.shownTime.value;
  const table = state.frameTable.value;
  const count = table.state === "ready" ? table.value.count : null;
  const button = (label: string, icon: Parameters<typeof Icon>[0]["name"], action: () => void) => (
    <button class="button icon plain" title={label} aria-label={label} onClick={action}>
      <Icon name={icon} />
    </button>
  );
  return (
    <div class="controls">
      {button("Previous moment (H)", "previous", () => selection.stepMoment(-1))}
      {button("One frame back (,)", "back", () => selection.stepFrame(-1))}
      <button
        class="button icon"
        title={state.isPlaying.value ? "Pause (Space)" : "Play (Space)"}
        aria-label={state.isPlaying.value ? "Pause" : "Play"}
        onClick={togglePlay}
      >
        <Icon name={state.isPlaying.value ? "pause" : "play"} />
      </button>
      {button("One frame on (.)", "on", () => selection.stepFrame(1))}
      {button("Next moment (L)", "next", () => selection.stepMoment(1))}
      {jobs.canAdd.value && (
        <button
          class="button icon plain"
          title="Box an object, to search for it or to follow it (B)"
          aria-label="Box an object"
          aria-pressed={state.isBoxing.value}
          onClick={toggleBoxing}
        >
          <Icon name="box" />
        </button>
      )}
      <div class="time">
        <span>{time === null ? "–:––.––" : formatTime(time)}</span>
        <small>
          {frame === null || count === null ? "" : `frame ${frame.toLocaleString("en")} of 0–${(count - 1).toLocaleString("en")}`}
        </small>
      </div>
      {state.videos.value.length > 1 && (
        <>
          <label class="hidden" for="video">
            Video
          </label>
          <select
            id="video"
            class="field"
            style={{ maxWidth: "9rem" }}
            value={String(state.videoId.value ?? "")}
            onChange={(event) => selection.showTime(Number(event.currentTarget.value), 0)}
          >
            {state.videos.value.map((one) => (
              <option key={one.id} value={String(one.id)}>
                {baseName(one.name)}
              </option>
            ))}
          </select>
        </>
      )}
      <label class="hidden" for="rate">
        Speed
      </label>
      <select
        id="rate"
        class="field"
        value={String(playbackRate.value)}
        onChange={(event) => (playbackRate.value = Number(event.currentTarget.value))}
      >
        {[0.25, 0.5, 1, 2, 4].map((rate) => (
          <option key={rate} value={String(rate)}>
            {rate}×
          </option>
        ))}
      </select>
    </div>
  );
}

export function VideoPane() {
  return (
    <section class="video" aria-label="Video">
      <Stage />
      <Controls />
      <Timeline />
    </section>
  );
}
