// The dialog that shows why a sighting was reported: view and frame with the matches between them, stage by stage.
import { useEffect, useRef, useState } from "preact/hooks";

import { frameUrl, fullViewUrl } from "../api/client";
import type { Evidence } from "../api/types";
import { STAGES, SHEET, layOut, placeOn, sizeOf, verdictOf } from "../logic/evidence";
import { type MatchCover, describeCover, matchCover } from "../logic/match_cover";
import { formatScore } from "../logic/format";
import { describeObject } from "../logic/object_evidence";
import { select } from "../selection";
import * as state from "../state";
import * as why from "../why";
import { Icon } from "./icons";

const pointsOf = (corners: readonly (readonly number[])[]) => corners.map((one) => one.join(",")).join(" ");

interface SheetProps {
  evidence: Evidence;
  cover: MatchCover | null;
  stage: number;
  isWhole: boolean;
  hasLines: boolean;
}

function Sheet({ evidence, cover, stage, isWhole, hasLines }: SheetProps) {
  const { sighting } = evidence;
  const video = state.videos.value.find((one) => one.id === sighting.video_id);
  const [width, height] = [video?.width_px ?? 0, video?.height_px ?? 0];
  const region = isWhole && width > 0 ? [0, 0, width, height] : evidence.region;
  const { view, frame, lines, hidden } = layOut(evidence, stage, region);
  const name = STAGES[evidence.stages[stage]?.name ?? "inliers"];
  // Hundreds of lines upon each other must not hide what they lead to.
  const opacity = Math.max(0.06, Math.min(0.3, 20 / Math.max(lines.length, 1)));
  const radius = lines.length > 100 ? 2 : 3;
  const outline = (evidence.pose?.outline ?? []).map((corner) => placeOn(frame, corner));
  return (
    <figure class="evidence">
      <svg viewBox={`0 0 ${SHEET.width} ${SHEET.height}`} role="img" aria-label={`${lines.length} matches between view and frame`} style={{ "--line-opacity": opacity }}>
        <clipPath id="evidence-frame">
          <rect x={frame.left} y={frame.top} {...sizeOf(frame)} />
        </clipPath>
        <rect class="ground" x={view.left} y={view.top} {...sizeOf(view)} />
        <image href={fullViewUrl(sighting.model_id, evidence.view.index)} x={view.left} y={view.top} {...sizeOf(view)} preserveAspectRatio="none" />
        <rect class="ground" x={frame.left} y={frame.top} {...sizeOf(frame)} />
        <svg x={frame.left} y={frame.top} {...sizeOf(frame)} viewBox={region.join(" ")} preserveAspectRatio="none">
          <image href={frameUrl(sighting.video_id, sighting.frame)} width={width} height={height} preserveAspectRatio="none" />
        </svg>
        {cover && cover.hull.length > 2 && (
          <polygon class="cover" points={pointsOf(cover.hull.map((corner) => placeOn(view, corner)))}>
            <title>{describeCover(cover)}</title>
          </polygon>
        )}
        <polygon class="outline under" points={pointsOf(outline)} clip-path="url(#evidence-frame)" />
        <polygon class="outline" points={pointsOf(outline)} clip-path="url(#evidence-frame)" />
        {lines.map(({ from, to, isInlier }, i) => (
          <g key={i} class={isInlier ? "match inlier" : "match"}>
            {hasLines && <line x1={from[0]} y1={from[1]} x2={to[0]} y2={to[1]} />}
            <circle cx={from[0]} cy={from[1]} r={isInlier ? radius : 1.5} />
            <circle cx={to[0]} cy={to[1]} r={isInlier ? radius : 1.5} />
          </g>
        ))}
      </svg>
      <figcaption class="muted">
        {name.what}
        {hidden > 0 ? `; ${hidden.toLocaleString("en")} of them lie elsewhere in the frame` : ""}
      </figcaption>
    </figure>
  );
}

function Stages({ evidence, stage, choose }: { evidence: Evidence; stage: number; choose: (stage: number) => void }) {
  return (
    <div class="stages" role="radiogroup" aria-label="Stage">
      {evidence.stages.map((one, i) => (
        <label key={one.name} class="stage-choice" data-chosen={i === stage}>
          <input type="radio" name="stage" checked={i === stage} onChange={() => choose(i)} />
          <strong>{one.matches.toLocaleString("en")}</strong>
          <span>{STAGES[one.name].label}</span>
        </label>
      ))}
    </div>
  );
}

/** What other models explain it; a click goes to the other object. */
function Rivals() {
  const all = why.rivals.value;
  if (all.length === 0) return null;
  return (
    <p class="rivals">
      Also explained by:{" "}
      {all.map((one, i) => (
        <span key={one.object}>
          {i > 0 && ", "}
          <button class="link" title={`Object ${one.object}, score ${one.isInFrame ? "in this frame" : "of the object"}`} onClick={() => select(one.object, { push: true })}>
            {one.model} {formatScore(one.score)}
          </button>
          {one.isInFrame ? "" : " at the same place"}
        </span>
      ))}
    </p>
  );
}

/** What all of the object's sightings say, doubts first. */
function WholeObject({ object }: { object: number }) {
  const detail = state.detail.value;
  if (detail?.state !== "ready" || detail.value.id !== object) return null;
  const { against, evidence } = detail.value;
  return (
    <ul class="whole-object">
      {against.length > 0 && <li class="doubt">Doubts: {against.join("; ")}</li>}
      {evidence !== null &&
        describeObject(evidence).map((text) => (
          <li key={text} class="muted">
            {text}
          </li>
        ))}
    </ul>
  );
}

function Body({ evidence }: { evidence: Evidence }) {
  const last = evidence.stages.length - 1;
  const [stage, setStage] = useState(last);
  const [isWhole, setIsWhole] = useState(false);
  const [hasLines, setHasLines] = useState(true);
  const { view } = evidence;
  const agreeing = evidence.matches.filter((one) => one.stages === evidence.stages.length);
  const cover = evidence.pose ? matchCover(agreeing.map((one) => one.template), view.outline) : null;
  return (
    <>
      <p class="verdict-text">{verdictOf(evidence)}</p>
      {cover && <p class={cover.isOnePatch ? "cover-text doubt" : "cover-text muted"}>{describeCover(cover)}</p>}
      <Rivals />
      <WholeObject object={evidence.sighting.object_id} />
      <Stages evidence={evidence} stage={stage} choose={setStage} />
      <Sheet evidence={evidence} cover={cover} stage={stage} isWhole={isWhole} hasLines={hasLines} />
      <div class="below">
        <span class="muted">
          {view.azimuth_deg === null || view.off_nadir_deg === null
            ? `Photo ${view.index + 1} of the model`
            : `View ${view.index}: azimuth ${view.azimuth_deg.toFixed(0)}°, ${view.off_nadir_deg.toFixed(0)}° off nadir`}
        </span>
        <label class="check">
          <input type="checkbox" checked={hasLines} onChange={(event) => setHasLines(event.currentTarget.checked)} />
          Lines
        </label>
        <label class="check">
          <input type="checkbox" checked={isWhole} onChange={(event) => setIsWhole(event.currentTarget.checked)} />
          Whole frame
        </label>
      </div>
    </>
  );
}

export function WhyDialog() {
  const dialog = useRef<HTMLDialogElement>(null);
  const asked = why.asked.value;
  const found = why.evidence.value;
  const object = state.selected.value;
  useEffect(() => {
    if (asked) dialog.current?.showModal();
    else dialog.current?.close();
  }, [asked]);
  const sighting = found.state === "ready" ? found.value.sighting : null;
  return (
    <dialog class="help why" ref={dialog} aria-labelledby="why-title" onClose={() => (why.asked.value = null)}>
      <header>
        <h2 id="why-title">
          Why {object ? `${object.model} ${object.id}` : "it"} was found
          {sighting && (
            <small class="muted">
              {" "}
              {state.describeTime(sighting.video_id, sighting.time_s)}, frame {sighting.frame.toLocaleString("en")}
              {asked?.at === null ? ", best sighting" : ""}
            </small>
          )}
        </h2>
        <button class="button icon plain" aria-label="Close" onClick={() => (why.asked.value = null)}>
          <Icon name="close" />
        </button>
      </header>
      {asked !== null && found.state === "loading" && (
        <div class="skeleton" role="status">
          <span class="hidden">Matching the frame again</span>
        </div>
      )}
      {found.state === "failed" && (
        <p class="problem" role="alert">
          {found.message}
        </p>
      )}
      {asked !== null && found.state === "ready" && (
        <Body key={`${found.value.sighting.object_id} ${found.value.sighting.frame}`} evidence={found.value} />
      )}
    </dialog>
  );
}
