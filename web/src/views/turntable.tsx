// The dialog in which a model turns: dragged or by the arrow keys through its views as they were rendered, with the views
// that matched, each of which leads to its sighting.
import { effect, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { fullViewUrl, thumbnailUrl, viewUrl } from "../api/client";
import type { Sighting } from "../api/types";
import { describeMatches, formatMetres, plural } from "../logic/format";
import { byNearness, describeDirection, fromDisc, nearest, onDisc, stepsAt, turn } from "../logic/turntable";
import * as state from "../state";
import * as turntable from "../turntable";
import { Icon } from "./icons";

const MAX_SHOWN = 24;
const AT_ONCE = 6;

/** The images of the views of one model, loaded from the present one outwards: small ones of all, whole ones where it rests. */
class ViewImages {
  private readonly small = new Map<number, HTMLImageElement>();
  private readonly whole = new Map<number, HTMLImageElement>();
  private readonly asked = new Set<string>();
  private underWay = 0;
  private isClosed = false;

  constructor(
    private readonly model: number,
    private readonly changed: () => void,
  ) {}

  best(view: number): HTMLImageElement | null {
    return this.whole.get(view) ?? this.small.get(view) ?? null;
  }

  /** The small image, which has the colours that a whole rendering lacks. */
  coloured(view: number): HTMLImageElement | null {
    return this.small.get(view) ?? null;
  }

  close() {
    this.isClosed = true;
  }

  loadWhole(view: number) {
    this.load(view, fullViewUrl(this.model, view), this.whole);
  }

  /** Keeps some requests under way, those nearest to where the model is looked at from first. */
  loadAll() {
    const order = byNearness(turntable.views.peek(), turntable.direction.peek());
    for (const view of order) {
      if (this.isClosed || this.underWay >= AT_ONCE) return;
      this.load(view.index, viewUrl(this.model, view.index), this.small);
    }
  }

  private load(view: number, url: string, into: Map<number, HTMLImageElement>) {
    if (this.asked.has(url)) return;
    this.asked.add(url);
    this.underWay++;
    const image = new Image();
    image.src = url;
    image
      .decode()
      .then(() => {
        into.set(view, image);
        if (!this.isClosed) this.changed();
      })
      // An image that cannot be had: the nearest of the others is shown.
      .catch(() => undefined)
      .finally(() => {
        this.underWay--;
        if (!this.isClosed) this.loadAll();
      });
  }
}

const imageVersion = signal(0);

/** Draws the nearest view that has come. */
function draw(canvas: HTMLCanvasElement, images: ViewImages) {
  const wanted = turntable.present.value;
  if (!wanted) return;
  const view = images.best(wanted.index) ? wanted : nearest(turntable.views.peek().filter((one) => images.best(one.index) !== null), wanted);
  const image = view && images.best(view.index);
  const context = canvas.getContext("2d");
  if (!image || !context) return;
  const scale = Math.min(canvas.width / image.naturalWidth, canvas.height / image.naturalHeight);
  const [width, height] = [image.naturalWidth * scale, image.naturalHeight * scale];
  context.imageSmoothingQuality = "high";
  context.clearRect(0, 0, canvas.width, canvas.height);
  const [left, top] = [(canvas.width - width) / 2, (canvas.height - height) / 2];
  context.drawImage(image, left, top, width, height);
  const coloured = images.coloured(view.index);
  if (coloured && coloured !== image) {
    // Brightness of the one, hue of the other.
    context.globalCompositeOperation = "color";
    context.drawImage(coloured, left, top, width, height);
    context.globalCompositeOperation = "source-over";
  }
  canvas.dataset["view"] = String(view.index);
}

function Stage({ model }: { model: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const images = new ViewImages(model, () => imageVersion.value++);
    let rest: ReturnType<typeof setTimeout> | undefined;
    const stop = effect(() => {
      void imageVersion.value;
      void turntable.views.value;
      if (canvas.current) draw(canvas.current, images);
    });
    const stopLoading = effect(() => {
      const view = turntable.present.value;
      images.loadAll();
      clearTimeout(rest);
      // Sharp where it rests; not for each view that a drag passes.
      if (view) rest = setTimeout(() => images.loadWhole(view.index), 120);
    });
    return () => {
      stop();
      stopLoading();
      clearTimeout(rest);
      images.close();
    };
  }, [model]);
  const view = turntable.present.value;
  const name = turntable.model.value.state === "ready" ? turntable.model.value.value.model : "";
  const turnBy = (right: number, up: number) => {
    if (!view) return;
    const steps = stepsAt(turntable.views.value, view);
    const from = { azimuth_deg: view.azimuth_deg, off_nadir_deg: view.off_nadir_deg };
    const next = turn({ ...from, azimuth_deg: from.azimuth_deg + right * steps.azimuth }, 0, 0, turntable.views.value);
    const wanted = nearest(turntable.views.value, turn({ ...next, off_nadir_deg: next.off_nadir_deg - up * steps.offNadir }, 0, 0, turntable.views.value));
    if (wanted) turntable.lookFrom(wanted.index);
  };
  return (
    <div
      class="turntable"
      role="slider"
      tabIndex={0}
      aria-label={`${name}, turned by drag or arrow keys`}
      aria-valuemin={0}
      aria-valuemax={360}
      aria-valuenow={Math.round(view?.azimuth_deg ?? 0)}
      aria-valuetext={view ? (turntable.isTurntable.value ? describeDirection(view) : `photo ${view.index + 1}`) : "loading"}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={(event) => {
        if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
        turntable.direction.value = turn(turntable.direction.value, event.movementX, turntable.isTurntable.value ? event.movementY : 0, turntable.views.value);
      }}
      onKeyDown={(event) => {
        const by = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] } as Record<string, [number, number]>)[event.key];
        if (!by) return;
        event.preventDefault();
        turnBy(...by);
      }}
    >
      <canvas ref={canvas} width="640" height="480" />
    </div>
  );
}

/** All directions, seen from above: the present one, and those of the views that matched. */
function Disc() {
  const views = turntable.views.value;
  const rim = views.reduce((most, one) => Math.max(most, one.off_nadir_deg), 0);
  const matched = new Map(turntable.matched.value.map((one) => [one.view, one.sightings]));
  const object = turntable.shown.value?.object?.id ?? null;
  const present = turntable.present.value;
  const look = (event: PointerEvent) => {
    const area = (event.currentTarget as Element).getBoundingClientRect();
    const at = [(2.3 * (event.clientX - area.left)) / area.width - 1.15, (2.3 * (event.clientY - area.top)) / area.height - 1.15] as const;
    turntable.direction.value = fromDisc(at, rim);
  };
  const size = 1 / Math.sqrt(Math.max(views.length, 20));
  return (
    <figure class="disc">
      <svg
        viewBox="-1.15 -1.15 2.3 2.3"
        role="img"
        aria-label={`${plural(matched.size, "view")} of ${views.length} matched`}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          look(event);
        }}
        onPointerMove={(event) => event.currentTarget.hasPointerCapture(event.pointerId) && look(event)}
      >
        <circle class="rim" r="1.1" />
        {views.map((one) => {
          const [x, y] = onDisc(one, rim);
          const found = matched.get(one.index);
          const kind = found ? (found[0]?.object_id === object ? "own" : "others") : "";
          return <circle key={one.index} class={`dot ${kind}`} cx={x} cy={y} r={found ? 0.8 * size : 0.3 * size} />;
        })}
        {present && <circle class="present" cx={onDisc(present, rim)[0]} cy={onDisc(present, rim)[1]} r={1.3 * size} />}
        <path class="front" d="M-0.06 -1.09 0 -1.15 0.06 -1.09z" />
      </svg>
      <figcaption class="muted">From above, front up. Large dots: views that matched.</figcaption>
    </figure>
  );
}

function Match({ model, view, sighting, isOwn }: { model: number; view: number; sighting: Sighting; isOwn: boolean }) {
  const isPresent = turntable.present.value?.index === view;
  return (
    <li>
      <button
        class={`match-view ${isPresent ? "present" : ""}`}
        title="Go to the sighting"
        onClick={() => turntable.goTo(sighting)}
        onFocus={() => turntable.lookFrom(view)}
        onPointerEnter={() => turntable.lookFrom(view)}
      >
        <img src={viewUrl(model, view)} alt="" width="72" height="54" loading="lazy" />
        <img src={thumbnailUrl(sighting.object_id, 160)} alt="" width="72" height="54" loading="lazy" />
        <span>
          <strong>{isOwn ? "This object" : `Object ${sighting.object_id}`}</strong>
          <span class="muted">
            {state.describeTime(sighting.video_id, sighting.time_s)}, {describeMatches(sighting.matches)}
          </span>
        </span>
      </button>
    </li>
  );
}

function Matches({ model }: { model: number }) {
  const object = turntable.shown.value?.object?.id ?? null;
  const matched = turntable.matched.value;
  const rows = matched.slice(0, MAX_SHOWN);
  return (
    <section class="match-views" aria-label="Views that matched">
      <h3>
        {matched.length === 0 ? "No view has matched yet" : `${plural(matched.length, "view")} matched`}
        {matched.length > rows.length && <span class="muted">, the best {rows.length} below</span>}
      </h3>
      <ul>
        {rows.map(({ view, sightings }) => {
          const best = sightings[0];
          return best && <Match key={view} model={model} view={view} sighting={best} isOwn={best.object_id === object} />;
        })}
      </ul>
    </section>
  );
}

export function TurntableDialog() {
  const dialog = useRef<HTMLDialogElement>(null);
  const shown = turntable.shown.value;
  const model = turntable.model.value;
  useEffect(() => {
    if (shown) dialog.current?.showModal();
    else dialog.current?.close();
  }, [shown]);
  const view = turntable.present.value;
  const name = shown ? state.modelName(shown.model) : "";
  return (
    <dialog class="help turning" ref={dialog} aria-labelledby="turning-title" onClose={() => (turntable.shown.value = null)}>
      <header>
        <h2 id="turning-title">
          {name}
          {model.state === "ready" && (
            <small class="muted">
              {" "}
              {plural(model.value.views.length, model.value.kind === "photos" ? "photo" : "rendered view")}
              {model.value.length_m === null ? "" : `, ${formatMetres(model.value.length_m)} long`}
            </small>
          )}
        </h2>
        <button class="button icon plain" aria-label="Close" onClick={() => (turntable.shown.value = null)}>
          <Icon name="close" />
        </button>
      </header>
      {shown !== null && model.state === "loading" && <div class="skeleton" role="status"><span class="hidden">Loading the views</span></div>}
      {model.state === "failed" && (
        <p class="problem" role="alert">
          {model.message}
        </p>
      )}
      {shown !== null && model.state === "ready" && (
        <div class="turning-panes">
          <div>
            <Stage model={shown.model} />
            <p class="muted below">
              <span>{view && (turntable.isTurntable.value ? `View ${view.index}: ${describeDirection(view)}` : `Photo ${view.index + 1}`)}</span>
              <span>
                Drag, or <kbd>←</kbd> <kbd>→</kbd> {turntable.isTurntable.value && <><kbd>↑</kbd> <kbd>↓</kbd></>}
              </span>
            </p>
          </div>
          <div class="turning-side">
            {turntable.isTurntable.value && <Disc />}
            <Matches model={shown.model} />
          </div>
        </div>
      )}
    </dialog>
  );
}
