// The video: its frame, controls and time line.
import * as jobs from "../jobs";
import { baseName, formatTime } from "../logic/format";
import { playbackRate } from "../player";
import * as selection from "../selection";
import * as state from "../state";
import { Icon } from "./icons";
import { Stage, toggleBoxing, togglePlay } from "./stage";
import { Timeline } from "./timeline";

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
