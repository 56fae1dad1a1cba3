// The time line of the video that is shown: a lane for each object with its moments, and what was searched.
import { computed } from "@preact/signals";
import { useRef } from "preact/hooks";

import { bandsOf, describeCoverage, endOf, listLeftOut } from "../logic/coverage";
import { formatTime, plural } from "../logic/format";
import { objectOf, videoObjects } from "../objects";
import * as selection from "../selection";
import * as state from "../state";
import { Swatch } from "./swatch";

const TICK_STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 120, 300, 600, 1800, 3600];

const length = computed(() => {
  const table = state.frameTable.value;
  return endOf(table.state === "ready" ? table.value.end : (state.video.value?.duration_s ?? 0), state.video.value);
});

const here = computed(() => (videoObjects.value?.video === state.videoId.value ? videoObjects.value : null));

/** The best objects; the selected one is always among them. */
const lanes = computed(() => {
  const best = (here.value?.ids ?? []).flatMap((id) => objectOf(id) ?? []);
  const selected = state.selected.value;
  const isHere = selected?.moments.some((one) => one.video_id === state.videoId.value);
  if (selected && isHere && !best.some((one) => one.id === selected.id)) best.unshift(selected);
  return best;
});

const percent = (time: number) => (length.value > 0 ? `${(100 * Math.min(time, length.value)) / length.value}%` : "0%");

/** What was searched, and what was not and why. */
function Searched() {
  const video = state.video.value;
  if (!video || length.value <= 0) return null;
  return (
    <>
      {bandsOf(video, length.value, state.modelNames.value.length).map(({ from, to, state: how, leftOut }) => (
        <div
          key={from}
          class={`searched ${how}`}
          style={{ left: percent(from), width: percent(to - from) }}
          title={how === "whole" ? "Searched for all models" : listLeftOut(leftOut, state.modelName)}
        />
      ))}
    </>
  );
}

const leftOut = computed(() => (state.video.value ? describeCoverage(state.video.value, state.modelName) : null));

/** The same in words, if something is left out. */
function LeftOut() {
  const video = state.video.value;
  if (!video || leftOut.value === null) return null;
  return (
    <div class="left-out">
      <div class="caption">left out</div>
      <p title={listLeftOut(video.left_out, state.modelName)}>{leftOut.value}</p>
    </div>
  );
}

function Ticks() {
  const end = length.value;
  const step = TICK_STEPS.find((one) => end / one <= 10) ?? 3600;
  const count = end > 0 ? Math.floor(end / step) + 1 : 0;
  return (
    <>
      {Array.from({ length: count }, (_, i) => i * step)
        .filter((time) => time < end * 0.97)
        .map((time) => (
          <span key={time} class="tick" style={{ left: percent(time) }}>
            {formatTime(time).replace(/\.00$/, "")}
          </span>
        ))}
    </>
  );
}

export function Timeline() {
  const track = useRef<HTMLDivElement>(null);
  const video = state.videoId.value;
  const scrub = (event: PointerEvent) => {
    if (!track.current || video === null || (event.type === "pointermove" && event.buttons !== 1)) return;
    if (event.type === "pointerdown") track.current.setPointerCapture(event.pointerId);
    const { left, width } = track.current.getBoundingClientRect();
    const part = Math.min(Math.max((event.clientX - left) / Math.max(width, 1), 0), 1);
    selection.showTime(video, part * length.value);
  };
  const time = state.shownTime.value ?? 0;
  const keys = (event: KeyboardEvent) => {
    const page = length.value / 10;
    const to = { Home: 0, End: length.value, PageUp: time + page, PageDown: time - page }[event.key];
    if (event.key === "ArrowUp" || event.key === "ArrowDown") selection.stepFrame(event.key === "ArrowUp" ? 1 : -1);
    else if (to !== undefined && video !== null) selection.showTime(video, Math.min(Math.max(to, 0), length.value));
    else return;
    event.preventDefault();
  };
  return (
    <div class="timeline" aria-label="Time line" role="group">
      <div class="over" style={{ height: `${24 + (leftOut.value === null ? 0 : 18) + 22 * lanes.value.length}px` }}>
        <div class="playhead" style={{ left: percent(time) }} />
      </div>
      <div class="ruler">
        <div class="caption">{plural(here.value?.total ?? 0, "object")}</div>
        <div
          class="track"
          ref={track}
          onPointerDown={scrub}
          onPointerMove={scrub}
          onKeyDown={keys}
          role="slider"
          tabIndex={0}
          aria-label="Time"
          aria-valuemin={0}
          aria-valuemax={length.value}
          aria-valuenow={time}
          aria-valuetext={formatTime(time)}
        >
          <Searched />
          <Ticks />
        </div>
      </div>
      <LeftOut />
      {lanes.value.map((object) => (
        <div
          key={object.id}
          class={`lane ${object.id === state.selectedId.value ? "selected" : ""} ${state.matcher.value(object) ? "" : "greyed"}`}
        >
          <button tabIndex={-1} title={`${object.model} ${object.id}`} onClick={() => selection.select(object.id, { push: true })}>
            <Swatch model={object.model} /> {object.model}
          </button>
          <div class="track">
            {object.moments
              .filter((one) => one.video_id === video)
              .map((one) => (
                <button
                  key={one.first_time_s}
                  class="moment"
                  tabIndex={-1}
                  style={{
                    left: percent(one.first_time_s),
                    width: percent(one.last_time_s - one.first_time_s),
                    background: state.colourOf(object.model),
                  }}
                  title={`${object.model}: ${formatTime(one.first_time_s)} to ${formatTime(one.last_time_s)}, ${plural(one.frames, "frame")}`}
                  aria-label={`${object.model} at ${formatTime(one.first_time_s)}`}
                  onClick={() => {
                    selection.select(object.id, { seek: false, push: true });
                    selection.showTime(one.video_id, one.first_time_s);
                  }}
                />
              ))}
          </div>
        </div>
      ))}
    </div>
  );
}
