// Over the frame: how far it is zoomed in, its brightness and contrast, the magnifier, full screen; where the part lies
// that is shown.
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";

import { shownPart } from "../logic/zoom";
import { frameCanvas, pictureVersion } from "../player";
import * as zoom from "../zoom";
import { Icon } from "./icons";

/** px */
const OVERVIEW = 132;

function Slider({ id, text, value }: { id: string; text: string; value: typeof zoom.brightness }) {
  return (
    <>
      <label for={id}>{text}</label>
      <input
        id={id}
        type="range"
        min="0.3"
        max="3"
        step="0.05"
        value={value.value}
        aria-valuetext={`${Math.round(100 * value.value)} %`}
        onInput={(event) => (value.value = Number(event.currentTarget.value))}
      />
      <output for={id}>{Math.round(100 * value.value)} %</output>
    </>
  );
}

/** Brightness and contrast. */
function Light({ close }: { close: () => void }) {
  const panel = useRef<HTMLDivElement>(null);
  useEffect(() => panel.current?.querySelector("input")?.focus(), []);
  return (
    <div
      id="light"
      class="light"
      role="group"
      aria-label="Brightness and contrast"
      ref={panel}
      onKeyDown={(event) => {
        if (event.key !== "Escape") return;
        event.preventDefault();
        close();
      }}
    >
      <Slider id="brightness" text="Brightness" value={zoom.brightness} />
      <Slider id="contrast" text="Contrast" value={zoom.contrast} />
      <button
        class="link"
        disabled={zoom.filter.value === "none"}
        onClick={() => {
          zoom.brightness.value = 1;
          zoom.contrast.value = 1;
        }}
      >
        As filmed
      </button>
    </div>
  );
}

export function StageTools() {
  const [isLightOpen, setLightOpen] = useState(false);
  const lightButton = useRef<HTMLButtonElement>(null);
  const percent = `${Math.round(100 * zoom.screenScale.value)} %`;
  const isNative = Math.abs(zoom.screenScale.value - 1) < 1e-3;
  const isWhole = zoom.zoom.value === null;
  return (
    <>
      <div class="stage-tools" role="group" aria-label="View of the frame">
        <button class="button icon plain" title="Zoom out (−)" aria-label="Zoom out" disabled={isWhole} onClick={() => zoom.zoomOut([zoom.area.value.width / 2, zoom.area.value.height / 2])}>
          <Icon name="less" />
        </button>
        <button
          class="button plain percent"
          title={isNative && !isWhole ? "Show the whole frame (0)" : "Show native pixels (1)"}
          aria-label={isNative && !isWhole ? `${percent}: show the whole frame` : `${percent}: show native pixels`}
          onClick={() => (isNative && !isWhole ? zoom.showWhole() : zoom.showNative([zoom.area.value.width / 2, zoom.area.value.height / 2]))}
        >
          {percent}
        </button>
        <button class="button icon plain" title="Zoom in (+)" aria-label="Zoom in" onClick={() => zoom.zoomIn([zoom.area.value.width / 2, zoom.area.value.height / 2])}>
          <Icon name="add" />
        </button>
        <button
          class="button icon plain"
          title="Magnifier under the pointer (Z)"
          aria-label="Magnifier"
          aria-pressed={zoom.hasLens.value}
          onClick={() => (zoom.hasLens.value = !zoom.hasLens.value)}
        >
          <Icon name="lens" />
        </button>
        <button
          class="button icon plain"
          title="Brightness and contrast"
          aria-label="Brightness and contrast"
          aria-expanded={isLightOpen}
          aria-pressed={zoom.filter.value !== "none"}
          ref={lightButton}
          onClick={() => setLightOpen(!isLightOpen)}
        >
          <Icon name="light" />
        </button>
        <button
          class="button icon plain"
          title={zoom.isFull.value ? "Leave full screen (F or Esc)" : "The video alone, in full screen (F)"}
          aria-label="Full screen"
          aria-pressed={zoom.isFull.value}
          onClick={() => zoom.setFull(!zoom.isFull.value)}
        >
          <Icon name="fit" />
        </button>
      </div>
      {isLightOpen && (
        <Light
          close={() => {
            setLightOpen(false);
            lightButton.current?.focus();
          }}
        />
      )}
    </>
  );
}

/** All of the frame, small, with the part that is shown; while it is zoomed in. */
export function Overview() {
  const isZoomed = zoom.zoom.value !== null;
  const canvas = useRef<HTMLCanvasElement>(null);
  const { width, height } = zoom.frame.value;
  const scale = OVERVIEW / Math.max(width, height, 1);
  const size = { width: Math.max(1, Math.round(width * scale)), height: Math.max(1, Math.round(height * scale)) };
  useEffect(() => {
    if (!isZoomed) return;
    return effect(() => {
      void pictureVersion.value;
      const context = canvas.current?.getContext("2d");
      if (!context) return;
      context.drawImage(frameCanvas, 0, 0, size.width, size.height);
    });
  }, [isZoomed, size.width, size.height]);
  if (!isZoomed) return null;
  const [x, y, across, down] = shownPart(zoom.frame.value, zoom.area.value, zoom.at.value);
  const percent = (part: number, of: number) => `${(100 * part) / of}%`;
  const centre = (event: PointerEvent) => {
    if (event.buttons !== 1) return;
    const [right, below] = [x + across / 2 - event.offsetX / scale, y + down / 2 - event.offsetY / scale];
    zoom.pan(right * zoom.at.value.scale, below * zoom.at.value.scale);
  };
  return (
    <div
      class="overview"
      style={{ width: size.width, height: size.height }}
      tabIndex={0}
      role="application"
      aria-label="The part of the frame that is shown: arrow keys move it, Home shows the whole frame"
      onKeyDown={(event) => {
        const step = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (step !== undefined) zoom.pan(((step[0] ?? 0) * zoom.area.value.width) / 8, ((step[1] ?? 0) * zoom.area.value.height) / 8);
        else if (event.key === "Home") zoom.showWhole();
        else return;
        event.preventDefault();
      }}
    >
      <canvas
        ref={canvas}
        width={size.width}
        height={size.height}
        aria-hidden="true"
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          centre(event);
        }}
        onPointerMove={centre}
      />
      <div class="part" style={{ left: percent(x, width), top: percent(y, height), width: percent(across, width), height: percent(down, height) }} />
    </div>
  );
}
