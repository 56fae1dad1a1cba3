// The selection: its crops, facts and review.
import { useEffect, useState } from "preact/hooks";

import { listDecisions, thumbnailUrl, viewUrl } from "../api/client";
import type { FoundObject, ObjectDetail, Review } from "../api/types";
import { MAX_DECISIONS, isOwnKnown, nameOf, ownDecision } from "../logic/decisions";
import { COORDINATE_STYLES, type CoordinateStyle, DASH, baseName, describeMatches, explainScore, formatAngle, formatMetres, formatPosition, formatScore, formatSpan, plural } from "../logic/format";
import { inOrder, lookOf, splitGroups, whyNotSplit } from "../logic/grouping";
import { formatUtcSpan } from "../logic/moments";
import { split } from "../grouping";
import { askForClip, canAdd } from "../jobs";
import { me } from "../me";
import * as notices from "../notices";
import * as objects from "../objects";
import { isRegrouping } from "../regroup";
import * as reviews from "../reviews";
import * as selection from "../selection";
import * as state from "../state";
import * as turntable from "../turntable";
import * as why from "../why";
import { Icon } from "./icons";
import { VerdictMark } from "./list";
import { Picture } from "./picture";
import { Swatch } from "./swatch";

function Crops({ object, detail }: { object: FoundObject; detail: ObjectDetail | null }) {
  const best = detail?.best ?? null;
  const hasView = best !== null && state.project.value.state === "ready" && state.project.value.value.has_views && !state.categoryNames.value.has(object.model);
  return (
    <div class="crops">
      <figure class="crop">
        <div class="frame">
          <Picture src={thumbnailUrl(object.id, 344, lookOf(object))} alt={`${object.model} in its best sighting`} />
        </div>
        <figcaption>
          {best ? (
            <button class="link" onClick={() => selection.showTime(best.video_id, best.time_s)}>
              best sighting, {state.describeTime(best.video_id, best.time_s)}
            </button>
          ) : (
            "best sighting"
          )}
        </figcaption>
      </figure>
      {hasView && (
        <figure class="crop view">
          <div class="frame">
            <button class="turn" title="Turn the model (T)" aria-label={`Turn ${object.model}, and show which of its views matched`} onClick={turntable.openSelected}>
              <Picture src={viewUrl(object.model_id, best.view_index)} alt={`The view of ${object.model} that matched`} />
            </button>
          </div>
          <figcaption>
            <button class="link" title="The matches between view and frame, stage by stage (W)" onClick={why.ask}>
              why
            </button>
            {" · "}
            <button class="link" title="Turn the model (T)" onClick={turntable.openSelected}>
              turn
            </button>
            {" · "}
            <span title={best.matches === 0 ? "Found by the shape of its edges" : "Matches that agree on the pose, counted by the search"}>
              {describeMatches(best.matches)}
            </span>
          </figcaption>
        </figure>
      )}
    </div>
  );
}

const STYLE_NAMES: Record<CoordinateStyle, string> = { decimal: "decimal", dms: "° ′ ″", mgrs: "MGRS", utm: "UTM" };

async function copy(text: string) {
  try {
    await navigator.clipboard.writeText(text);
    notices.notify(`Copied ${text}`);
  } catch {
    notices.notify("The browser does not allow copying; select the text instead.", "error");
  }
}

function Position({ object }: { object: FoundObject }) {
  const place = object.place;
  if (!place) {
    const reason = state.cameraPath.value?.source === null ? "no telemetry" : "too few sightings that agree";
    return <dd title="A place needs telemetry and sightings whose lines of sight meet">{`${DASH} (${reason})`}</dd>;
  }
  const style = state.coordinateStyle.value;
  const text = formatPosition(place.latitude_deg, place.longitude_deg, style);
  return (
    <dd>
      {text}{" "}
      <button class="link" aria-label="Copy the position" title="Copy" onClick={() => void copy(text)}>
        copy
      </button>
    </dd>
  );
}

/** How coordinates are written, here and on the map. */
function CoordinateChoice() {
  return (
    <select
      class="link"
      aria-label="Coordinates as"
      value={state.coordinateStyle.value}
      onChange={(event) => (state.coordinateStyle.value = event.currentTarget.value as CoordinateStyle)}
    >
      {COORDINATE_STYLES.map((one) => (
        <option key={one} value={one}>
          {STYLE_NAMES[one]}
        </option>
      ))}
    </select>
  );
}

/** Each moment by itself; those that are chosen can be split off. */
function Moments({ object, chosen, choose }: { object: FoundObject; chosen: ReadonlySet<number>; choose: (next: ReadonlySet<number>) => void }) {
  const nameOfVideo = (id: number) => baseName(state.videos.value.find((one) => one.id === id)?.name ?? String(id));
  const toggle = (id: number) => {
    const next = new Set(chosen);
    if (!next.delete(id)) next.add(id);
    choose(next);
  };
  return inOrder(object.moments).map((one) => {
    const [span, name] = [formatSpan(one.first_time_s, one.last_time_s), nameOfVideo(one.video_id)];
    return (
      <dd key={one.id} class="moment">
        {state.canReview.value && (
          <input type="checkbox" aria-label={`Choose ${span} in ${name}`} checked={chosen.has(one.id)} onChange={() => toggle(one.id)} />
        )}
        <button class="link" title={plural(one.frames, "frame")} onClick={() => selection.showTime(one.video_id, one.first_time_s)}>
          {span}
        </button>{" "}
        in {name}
      </dd>
    );
  });
}

/** Makes the chosen moments another object. */
function Split({ object, chosen }: { object: FoundObject; chosen: ReadonlySet<number> }) {
  const whyNot = whyNotSplit(object, chosen);
  const isBusy = isRegrouping.value;
  // Pressed by key, it hands the focus on when it goes.
  const run = async (isByKey: boolean) => {
    await split(object, chosen);
    if (isByKey && document.activeElement === document.body) document.querySelector<HTMLElement>(".inspector .seen button")?.focus();
  };
  return (
    <button
      class="link"
      aria-disabled={whyNot !== null || isBusy}
      title={whyNot ?? "They are of another object"}
      onClick={(event) => void run(event.detail === 0)}
    >
      {isBusy ? "splitting off" : "split off"}
      {whyNot === null && !isBusy && ` ${plural(splitGroups(object, chosen)[1].length, "moment")}`}
    </button>
  );
}

/** When each video shows it, or each moment; a click goes there. */
function Seen({ object }: { object: FoundObject }) {
  const [areMomentsShown, setAreMomentsShown] = useState(false);
  const [chosen, setChosen] = useState<ReadonlySet<number>>(new Set());
  const isOpen = areMomentsShown && object.moments.length > 1;
  return (
    <div class={`wide seen ${isOpen ? "open" : ""}`}>
      <dt>
        Seen
        {object.moments.length > 1 && (
          <button class="link" aria-expanded={isOpen} title="Each moment by itself" onClick={() => setAreMomentsShown(!isOpen)}>
            {plural(object.moments.length, "moment")}
          </button>
        )}
        {isOpen && state.canReview.value && <Split object={object} chosen={chosen} />}
      </dt>
      {isOpen && <Moments object={object} chosen={chosen} choose={setChosen} />}
      {!isOpen && state.seenOf(object).map((one) => (
        <dd key={`video-${one.video_id}`}>
          <button class="link" title={`${one.video}\n${plural(one.frames, "frame")}`} onClick={() => selection.showTime(one.video_id, one.first_time_s)}>
            {formatSpan(one.first_time_s, one.last_time_s)}
          </button>{" "}
          in {baseName(one.video)}
          {one.first_utc !== null && one.last_utc !== null && (
            <span class="muted" title={`${one.first_utc} to ${one.last_utc}`}>{` (${formatUtcSpan(one.first_utc, one.last_utc)})`}</span>
          )}
        </dd>
      ))}
    </div>
  );
}

function Facts({ object, detail }: { object: FoundObject; detail: ObjectDetail | null }) {
  const place = object.place;
  const best = detail?.best ?? null;
  return (
    <div>
      <div class="facts-head">
        <h2>
          <Swatch model={object.model} /> {object.model}
        </h2>
        <span class="muted">
          object {object.id}
          {detail?.rank ? `, rank ${detail.rank.toLocaleString("en")}` : ""}, {plural(object.frames, "frame")}
        </span>
        <VerdictMark object={object} />
        {canAdd.value && (
          <button
            class="link"
            title="A video of this object's moment with its outline, name and track drawn, and its telemetry"
            onClick={() => void askForClip(object)}
          >
            make a clip
          </button>
        )}
      </div>
      <dl class="facts-grid">
        <div>
          <dt>Score</dt>
          <dd title={explainScore(object.score)}>{formatScore(object.score, 3)}</dd>
        </div>
        <Seen key={object.id} object={object} />
        {object.against.length > 0 && (
          <div class="wide">
            <dt>Doubts</dt>
            <dd>{object.against.join("; ")}</dd>
          </div>
        )}
        <div class="wide">
          <dt>
            Position (WGS 84)
            {place && <CoordinateChoice />}
          </dt>
          <Position object={object} />
        </div>
        <div>
          <dt>90 % within</dt>
          <dd title="CE90: radius of the horizontal circle that holds the true place with 90 %">
            {formatMetres(place?.ce90_m)}
          </dd>
        </div>
        <div>
          <dt>Above ellipsoid</dt>
          <dd title="Height above the WGS 84 ellipsoid, which lies up to 100 m from sea level">
            {place ? `${formatMetres(place.altitude_m)} ± ${formatMetres(place.le90_m)}` : DASH}
          </dd>
        </div>
        <div>
          <dt>Heading</dt>
          <dd title="Of its front, clockwise from north">{formatAngle(object.heading_deg)}</dd>
        </div>
        <div>
          <dt>Speed</dt>
          <dd>{object.speed_m_s === null ? DASH : object.speed_m_s === 0 ? "standing" : `${object.speed_m_s.toFixed(1)} m/s`}</dd>
        </div>
        <div>
          <dt>Distance</dt>
          <dd title="From the camera to the object, in its best sighting">
            {formatMetres(best?.distance_m)}
            {best?.sigma_distance_m ? ` ± ${formatMetres(best.sigma_distance_m)}` : ""}
          </dd>
        </div>
      </dl>
    </div>
  );
}

const formatWhen = (utc_us: number) => new Date(utc_us / 1000).toLocaleString([], { dateStyle: "short", timeStyle: "short" });

/** All decisions about an object that has come with the latest ones only; null: not read yet, or all have come. */
function useAllDecisions(object: FoundObject): Review[] | null {
  const reader = me.value;
  const [read, setRead] = useState<{ id: number; reader: string; decisions: Review[] } | null>(null);
  const isCut = object.decisions.length >= MAX_DECISIONS;
  useEffect(() => {
    if (!isCut) return;
    const abort = new AbortController();
    listDecisions(object.id, abort.signal)
      .then((decisions) => {
        reviews.setStored(object.id, reader, decisions);
        setRead({ id: object.id, reader, decisions });
      })
      .catch((error: unknown) => !abort.signal.aborted && notices.notifyError(error));
    return () => abort.abort();
  }, [object.id, isCut, object.decisions, reader]);
  return isCut && read?.id === object.id && read.reader === reader ? read.decisions : null;
}

/** Who decided what and when, beside one's own decision; nothing where nobody else did. */
function Decisions({ object, shown }: { object: FoundObject; shown: readonly Review[] }) {
  if (!shown.some((one) => one.reviewer !== me.value)) return null;
  const team = object.review?.verdict ?? "undecided";
  return (
    <div class="decisions">
      <h3>{object.is_disputed ? `Disputed. Team: ${team} (the latest)` : `Team: ${team}`}</h3>
      <ul aria-label="Who decided what">
        {shown.map((one) => (
          <li key={one.reviewer}>
            <span class={`verdict ${one.verdict ?? ""}`}>
              {one.verdict && <Icon name={one.verdict === "accepted" ? "accept" : "reject"} />}
              {one.verdict ?? "note"}
            </span>{" "}
            <strong>{nameOf(one.reviewer, me.value)}</strong> <time>{formatWhen(one.updated_utc_us)}</time>
            {one.note !== "" && <q>{one.note}</q>}
          </li>
        ))}
      </ul>
    </div>
  );
}

interface Draft {
  id: number;
  note: string;
  /** Something of it is stored. */
  isKept: boolean;
}

/** ms without a letter, after which a note is stored */
const PAUSE_MS = 700;

/** All that is typed in one go is one step of undo. */
function keep(draft: Draft) {
  draft.isKept = reviews.note(draft.id, draft.note, draft.isKept) || draft.isKept;
}

/** Stores a note while it is typed, and before the page is left. */
function useAutoSave(draft: Draft | null) {
  useEffect(() => {
    if (draft === null) return;
    const store = () => keep(draft);
    const timer = setTimeout(store, PAUSE_MS);
    const storeAtOnce = () => {
      reviews.hurry();
      store();
    };
    window.addEventListener("pagehide", storeAtOnce);
    return () => {
      clearTimeout(timer);
      window.removeEventListener("pagehide", storeAtOnce);
    };
  }, [draft]);
}

/** The reader's own decision, and those of others. */
function ReviewPanel({ object }: { object: FoundObject }) {
  const all = useAllDecisions(object);
  const own = ownDecision(object, me.value);
  const isKnown = all !== null || isOwnKnown(object, me.value);
  const verdict = own?.verdict ?? null;
  const stored = own?.note ?? "";
  // What is typed belongs to the object that was selected as it was typed.
  const [draft, setDraft] = useState<Draft | null>(null);
  const isPending = objects.pendingReviews.value.has(object.id);
  const save = () => {
    if (draft !== null) keep(draft);
    setDraft(null);
  };
  const type = (note: string) => {
    if (draft !== null && draft.id !== object.id) save();
    setDraft({ id: object.id, note, isKept: draft?.id === object.id && draft.isKept });
  };
  useAutoSave(draft);
  // The same as the keys. A button that was clicked does not keep the focus: Space plays.
  const decide = (chosen: "accepted" | "rejected") => (event: MouseEvent) => {
    if (event.detail > 0) (event.currentTarget as HTMLElement).blur();
    reviews.decide(chosen);
  };
  const many = reviews.marked.value.size > 0 ? ` ${reviews.marked.value.size.toLocaleString("en")}` : "";
  const statusOf = () => {
    if (state.isQueueDone.value) return reviews.queueEnd.value;
    if (isPending) return "Saving";
    if (own) return `Saved ${formatWhen(own.updated_utc_us)}`;
    if (!state.canReview.value) return reviews.whyNoReview.value;
    if (!isKnown) return "Loading what you decided";
    return object.review ? "Not reviewed by you" : "Not reviewed";
  };
  return (
    <div class="review">
      <div class="buttons">
        <button
          class="button accept"
          aria-pressed={verdict === "accepted"}
          disabled={!state.canReview.value || !isKnown}
          onClick={decide("accepted")}
        >
          <Icon name="accept" /> Accept{many} <kbd>A</kbd>
        </button>
        <button
          class="button reject"
          aria-pressed={verdict === "rejected"}
          disabled={!state.canReview.value || !isKnown}
          onClick={decide("rejected")}
        >
          <Icon name="reject" /> Reject{many} <kbd>X</kbd>
        </button>
      </div>
      {verdict !== null && state.canReview.value && (
        <button class="link take-back" title="Takes your decision back; the note stays" onClick={() => reviews.review(object.id, null)}>
          Not reviewed
        </button>
      )}
      <label class="hidden" for="note">
        Note
      </label>
      <textarea
        id="note"
        class="field"
        placeholder="Note (N)"
        maxLength={2000}
        disabled={!state.canReview.value}
        readOnly={!isKnown}
        value={draft?.id === object.id ? draft.note : stored}
        onInput={(event) => type(event.currentTarget.value)}
        onBlur={save}
      />
      <div class="status" role="status">
        {statusOf()}
      </div>
      <Decisions object={object} shown={all ?? object.decisions} />
    </div>
  );
}

export function Inspector() {
  const object = state.selected.value;
  const detail = state.detail.value;
  if (!object) {
    return (
      <section class="inspector idle" aria-label="Selection">
        Choose an object in the list, the video, the time line or the map to see what is known of it.
      </section>
    );
  }
  const loaded = detail?.state === "ready" && detail.value.id === object.id ? detail.value : null;
  return (
    <section class="inspector" aria-label="Selection">
      <Crops object={object} detail={loaded} />
      <div>
        <Facts object={object} detail={loaded} />
        {detail?.state === "failed" && (
          <p class="muted" role="alert">
            {detail.message}
          </p>
        )}
      </div>
      <ReviewPanel object={object} />
    </section>
  );
}
