// What the page shows while nothing was searched yet: the three steps to the first finds, and a sample.
import { useRef } from "preact/hooks";

import { type StepState, stepsOf } from "../logic/first_steps";
import { forReaders } from "../logic/errors";
import * as jobs from "../jobs";
import * as state from "../state";
import { Icon } from "./icons";

const CAD_AND_PHOTOS = ".glb,.gltf,.obj,.ac,.dae,.3ds,.ply,.stl,image/*";
const VIDEOS = "video/*,.ts,.m2ts,.mts,.mkv,.csv,.srt,.klv";
const NAMES: Record<StepState, string> = { open: "next", waits: "later", runs: "in progress", done: "done" };

function Step({ number, title, how, children }: { number: number; title: string; how: StepState; children: preact.ComponentChildren }) {
  return (
    <li class={`step ${how}`} aria-current={how === "open" || how === "runs" ? "step" : undefined}>
      <span class="number" aria-hidden="true">
        {how === "done" ? <Icon name="accept" /> : number}
      </span>
      <div>
        <h3>
          {title} <span class="hidden">({NAMES[how]})</span>
        </h3>
        {children}
      </div>
    </li>
  );
}

function Choose({ label, accept, how }: { label: string; accept: string; how: StepState }) {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button class={how === "open" ? "button primary" : "button"} disabled={how === "waits"} onClick={() => input.current?.click()}>
        {label}
      </button>
      <input
        ref={input}
        class="hidden"
        type="file"
        multiple
        accept={accept}
        tabIndex={-1}
        aria-label={label}
        onChange={(event) => {
          jobs.addFiles([...(event.currentTarget.files ?? [])]);
          event.currentTarget.value = "";
        }}
      />
    </>
  );
}

export function FirstSteps() {
  const project = state.project.value;
  if (project.state !== "ready") return null;
  const steps = stepsOf(project.value, jobs.jobs.value, jobs.uploads.value.length);
  const progress = steps.progress === "" ? "" : ` ${steps.progress}`;
  const hasBegun = steps.object !== "open" || steps.video !== "waits";
  return (
    <div class="first-steps">
      <ol>
        <Step number={1} title="An object" how={steps.object}>
          {steps.object === "done" && <p>There is something to search for.</p>}
          {steps.object === "runs" && <p role="status">Its model is made:{progress}.</p>}
          {steps.object === "open" && <p>What is to be found: photos of it from several sides, or one CAD file.</p>}
          {steps.object !== "runs" && <Choose label={steps.object === "open" ? "Choose photos or a CAD file" : "Another object"} accept={CAD_AND_PHOTOS} how={steps.object} />}
        </Step>
        <Step number={2} title="A video" how={steps.video}>
          {steps.video === "runs" ? (
            <p role="status">{steps.object === "runs" ? "It comes after the model" : `Under way:${progress}`}.</p>
          ) : (
            <p>With its telemetry, if there is a file of it: then the finds have places on the map.</p>
          )}
          {steps.video !== "runs" && <Choose label="Choose a video" accept={VIDEOS} how={steps.video} />}
        </Step>
        <Step number={3} title="The finds" how={steps.finds}>
          <p role={steps.finds === "runs" ? "status" : undefined}>
            {steps.finds === "runs" ? `The video is searched:${progress}.` : "They appear in the list as soon as the search has them."}
          </p>
        </Step>
      </ol>
      {steps.failure !== "" && (
        <p class="problem" role="alert">
          {forReaders(steps.failure)}
        </p>
      )}
      {project.value.has_sample && !hasBegun && (
        <div class="sample">
          <p>Nothing at hand? The sample is made on this machine in some minutes: a jeep, and a simulated flight over a small town.</p>
          <button class="button" onClick={() => void jobs.trySample()}>
            Try the sample
          </button>
        </div>
      )}
      <p class="muted">
        Files can also be dropped anywhere on the page.
      </p>
    </div>
  );
}
