// The panel of jobs: what is uploaded, searched and made, how long yet; and the dialog that names a new model.
import { useEffect, useRef, useState } from "preact/hooks";

import { jobFileUrl } from "../api/client";
import type { Job } from "../api/types";
import { forReaders, messageOf } from "../logic/errors";
import { plural } from "../logic/format";
import { describeDone, describeFailed, followedObject, needsNewSearch } from "../logic/job_words";
import { boxesToSend } from "../logic/photo_box";
import { cleanModelName, formatBehind, formatLeft, kindOf, modelNameOf } from "../logic/uploads";
import { NO_FILTERS } from "../logic/filters";
import * as jobs from "../jobs";
import { needObjects, objectOf } from "../objects";
import { notifyError } from "../notices";
import { frameCanvas } from "../player";
import * as selection from "../selection";
import * as state from "../state";
import * as turntable from "../turntable";
import { Icon } from "./icons";
import { Library } from "./library";
import { type BoxedPhoto, PhotoBoxes, isMarked, readPhotos } from "./photo_box";

const WHAT = { index: "search", live: "live source", track: "follow", model: "make the model", copy: "copy for browsers", clip: "clip", refine: "refine the categories", sample: "simulate", remove: "remove" } as const;
const FILES = { clip: "Save the clip", telemetry: "Save its telemetry", categories: "Save the refined model" } as const;

function Bar({ of, part }: { of: string; part: number | null }) {
  return (
    <div
      class={`meter ${part === null ? "unknown" : ""}`}
      role="progressbar"
      aria-label={of}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={part === null ? undefined : Math.round(100 * part)}
    >
      <span style={part === null ? undefined : { width: `${100 * part}%` }} />
    </div>
  );
}

function describe(job: Job): string {
  if (job.state === "queued") return "waits";
  if (job.state === "done") {
    const id = followedObject(job);
    const followed = (id === null ? undefined : objectOf(id)) ?? null;
    return forReaders(describeDone(job, jobs.videoOf(job)?.objects ?? null, followed)) || "done";
  }
  if (job.state === "failed") return forReaders(describeFailed(job));
  if (job.state === "cancelled") return "cancelled";
  if (job.cancel_asked) return "ending";
  const of = job.total === null ? plural(job.done, job.unit.replace(/s$/, "")) : `${job.done.toLocaleString("en")} of ${job.total.toLocaleString("en")} ${job.unit}`;
  const left = job.left_s === null ? "" : `, ${formatLeft(job.left_s)}`;
  return job.done > 0 ? of + left : "begins";
}

/** The model that a job has made, once a search has brought it into the index. */
function TurnModel({ name }: { name: string }) {
  const project = state.project.value;
  const model = project.state === "ready" && project.value.has_views ? project.value.models.find((one) => one.name === name) : undefined;
  if (!model) return null;
  return (
    <button class="button" onClick={() => turntable.open(model.id, null, null)}>
      Turn it
    </button>
  );
}

/** Closes the panel, and goes to what a job has found. */
function Show({ onClick }: { onClick: () => void }) {
  return (
    <div class="job-files">
      <button
        class="button"
        onClick={() => {
          jobs.isOpen.value = false;
          onClick();
        }}
      >
        Show
      </button>
    </div>
  );
}

/** The way on from a search: to what it has found, or to a search that can find it. */
function Found({ job }: { job: Job }) {
  const video = job.kind === "index" || job.kind === "live" ? jobs.videoOf(job) : null;
  if (video === null) return null;
  if (needsNewSearch(job)) {
    return (
      <div class="job-files">
        <button class="button" title="Deletes what was found in it, and searches all of it. Reviews stay" onClick={() => jobs.askToSearchAgain(video)}>
          Search it from the beginning
        </button>
      </div>
    );
  }
  if (job.state !== "done" || video.objects === 0) return null;
  const show = () => {
    state.setFilters({ ...NO_FILTERS, thresholds: state.filters.value.thresholds, video: video.id });
    selection.stepToEnd("first");
  };
  return <Show onClick={show} />;
}

/** The way on from a box that was followed: to the object that it has become. */
function ShowFollowed({ job }: { job: Job }) {
  const id = followedObject(job);
  // The end of the job may be told before the server has read what the job wrote.
  const version = state.indexVersion.value;
  useEffect(() => {
    if (id !== null) needObjects([id]).catch(notifyError);
  }, [id, version]);
  if (id === null || objectOf(id) === undefined) return null;
  return <Show onClick={() => selection.select(id, { push: true })} />;
}

function Row({ job }: { job: Job }) {
  const isActive = job.state === "queued" || job.state === "running";
  const behind = formatBehind(job);
  return (
    <li class={`job ${job.state}`}>
      <div class="job-head">
        <strong title={job.title}>{job.title}</strong>
        <span class="muted">{WHAT[job.kind]}</span>
        {isActive && (
          <button class="link" disabled={job.cancel_asked} onClick={() => jobs.cancel(job)}>
            {job.kind === "live" ? "Stop" : "Cancel"}
          </button>
        )}
        {(job.state === "failed" || job.state === "cancelled") && (
          <button class="link" onClick={() => jobs.retry(job)}>
            Retry
          </button>
        )}
        {!isActive && (
          <button class="link" title="Remove it from this list, for everybody" onClick={() => jobs.remove(job)}>
            Remove
          </button>
        )}
      </div>
      {job.state === "running" && <Bar of={job.title} part={job.total ? job.done / job.total : null} />}
      <div class="job-state" role={job.state === "failed" ? "alert" : undefined}>
        {describe(job)}
        {behind !== null && !job.cancel_asked && (
          <>
            , <span class="behind">{behind}</span>
          </>
        )}
      </div>
      {job.files.length > 0 && (
        <div class="job-files">
          {job.files.map((name) => (
            <a key={name} class="button" href={jobFileUrl(job.id, name)} download>
              {FILES[name]}
            </a>
          ))}
        </div>
      )}
      <Found job={job} />
      <ShowFollowed job={job} />
      {job.kind === "model" && job.state === "done" && (
        <div class="job-files">
          {state.videos.value.length > 0 && (
            <button class="button" onClick={() => void jobs.searchAll()}>
              Search all videos for it
            </button>
          )}
          <TurnModel name={job.title} />
        </div>
      )}
    </li>
  );
}

export function JobsButton() {
  const count = jobs.active.value.length + jobs.uploads.value.length;
  if (!jobs.canAdd.value) return null;
  return (
    <button class="button jobs-button" aria-expanded={jobs.isOpen.value} onClick={() => (jobs.isOpen.value = !jobs.isOpen.value)}>
      <Icon name="add" /> {count > 0 ? plural(count, "job") : "Add"}
    </button>
  );
}

/** Types whose usual length `victorious track` knows. */
const TYPES = ["vehicle", "car", "van", "truck", "bus", "tank", "motorcycle", "person", "helicopter", "airplane", "boat", "ship", "animal", "building", "tree"];

function LiveSource() {
  const [url, setUrl] = useState("");
  const [problem, setProblem] = useState("");
  const start = async (event: Event) => {
    event.preventDefault();
    setProblem("");
    try {
      await jobs.watch(url);
      setUrl("");
    } catch (error) {
      setProblem(messageOf(error));
    }
  };
  return (
    <form class="live" onSubmit={(event) => void start(event)}>
      <label for="live-url">Or the address of a live source</label>
      <div class="corners">
        <input
          id="live-url"
          class="field"
          autocomplete="off"
          spellcheck={false}
          placeholder="rtsp://camera/stream, udp://, srt://"
          value={url}
          onInput={(event) => setUrl(event.currentTarget.value)}
        />
        <button class="button" disabled={url.trim() === ""}>
          Start
        </button>
      </div>
      {problem !== "" && (
        <p class="problem" role="alert">
          {problem}
        </p>
      )}
    </form>
  );
}

export function JobsPanel() {
  const input = useRef<HTMLInputElement>(null);
  if (!jobs.isOpen.value) return null;
  const nothing = jobs.jobs.value.length + jobs.uploads.value.length === 0;
  return (
    <aside class="jobs" aria-label="Jobs">
      <header>
        <h2>Videos and models</h2>
        <button class="button icon plain" aria-label="Close" onClick={() => (jobs.isOpen.value = false)}>
          <Icon name="close" />
        </button>
      </header>
      <button class="dropzone" onClick={() => input.current?.click()}>
        <strong>Choose files, or drop them anywhere</strong>
        <span>Videos are searched for all models. Photos or one CAD file make a new model.</span>
      </button>
      <input
        ref={input}
        class="hidden"
        type="file"
        multiple
        tabIndex={-1}
        aria-label="Files to add"
        onChange={(event) => {
          jobs.addFiles([...(event.currentTarget.files ?? [])]);
          event.currentTarget.value = "";
        }}
      />
      <LiveSource />
      <ul>
        {jobs.uploads.value.map((one) => (
          <li key={`upload-${one.id}`} class="job">
            <div class="job-head">
              <strong title={one.name}>{one.name}</strong>
              <span class="muted">upload</span>
              <button class="link" onClick={one.abort}>
                Cancel
              </button>
            </div>
            <Bar of={one.name} part={one.done} />
          </li>
        ))}
        {jobs.jobs.value.map((one) => (
          <Row key={one.id} job={one} />
        ))}
      </ul>
      {nothing && <p class="muted">Nothing is being worked on.</p>}
      <Library />
    </aside>
  );
}

/** px */
const CROP = { width: 320, height: 160 };

/** What was boxed, cut from the frame that is shown. */
function Crop({ source }: { source: { video: number; frame: number; box: number[] } }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [x = 0, y = 0, width = 1, height = 1] = source.box;
  const scale = Math.min(CROP.width / width, CROP.height / height);
  useEffect(() => {
    const video = state.videos.value.find((one) => one.id === source.video);
    const context = canvas.current?.getContext("2d");
    if (!video || !context) return;
    // The browser may deliver another size than the video was indexed in.
    const [right, down] = [frameCanvas.width / video.width_px, frameCanvas.height / video.height_px];
    context.drawImage(frameCanvas, x * right, y * down, width * right, height * down, 0, 0, context.canvas.width, context.canvas.height);
  }, [source]);
  return (
    <canvas ref={canvas} width={Math.round(width * scale)} height={Math.round(height * scale)} role="img" aria-label="What you boxed" />
  );
}

/** The photos of a model that is made from files, and what is boxed in each. */
function usePhotos(source: jobs.ModelSource | null) {
  const [photos, setPhotos] = useState<readonly BoxedPhoto[]>([]);
  const [pictures, setPictures] = useState<readonly (ImageBitmap | null)[]>([]);
  useEffect(() => {
    setPhotos([]);
    setPictures([]);
    const files = source && "files" in source ? source.files.filter((one) => kindOf(one.name) === "photo") : [];
    if (files.length === 0) return;
    let isOver = false;
    const reading = readPhotos(files, () => isOver);
    void reading.then((read) => {
      if (isOver) return;
      setPhotos(read.map((one) => one.photo));
      setPictures(read.map((one) => one.picture));
    });
    return () => {
      isOver = true;
      void reading.then((read) => read.forEach(({ picture }) => picture?.close()));
    };
  }, [source]);
  const change = (at: number, next: Partial<BoxedPhoto>) => setPhotos((all) => all.map((one, i) => (i === at ? { ...one, ...next } : one)));
  return { photos, pictures, change };
}

export function ModelDialog() {
  const dialog = useRef<HTMLDialogElement>(null);
  const source = jobs.askedModel.value;
  const files = source && "files" in source ? source.files : [];
  const first = files[0]?.name ?? "";
  const [name, setName] = useState("");
  const [length, setLength] = useState("");
  const [isSearched, setIsSearched] = useState(true);
  const [isFollowed, setIsFollowed] = useState(false);
  const [type, setType] = useState("");
  const nameField = useRef<HTMLInputElement>(null);
  const boxed = source && !("files" in source) ? source : null;
  const { photos, pictures, change } = usePhotos(source);
  useEffect(() => {
    if (source) {
      setName(first === "" ? "" : modelNameOf(first));
      setLength("");
      setIsSearched(true);
      setIsFollowed(false);
      setType("");
      dialog.current?.showModal();
    } else dialog.current?.close();
  }, [source, first]);
  useEffect(() => {
    if (source && !isFollowed) nameField.current?.focus();
  }, [source, isFollowed]);
  // Before the photos are read, none says what the object is.
  const hasPhotos = files.some((one) => kindOf(one.name) === "photo");
  const isValid = name !== "" && (!hasPhotos || (photos.length > 0 && photos.every(isMarked)));
  const send = (source: jobs.ModelSource) => {
    const boxes = boxesToSend(photos.map((one) => one.box), photos.map((one) => one.size));
    const from = "files" in source ? { files: source.files, boxes } : source;
    jobs.addModel(name, from, length.trim() === "" ? null : Number(length), isSearched && state.videos.value.length > 0);
  };
  return (
    <dialog class="help model" ref={dialog} aria-labelledby="model-title" onClose={() => (jobs.askedModel.value = null)}>
      <form
        method="dialog"
        onSubmit={() => {
          if (boxed && isFollowed) void jobs.follow(boxed, type);
          else if (source) send(source);
        }}
      >
        <header>
          <h2 id="model-title">{boxed ? "What you boxed" : "New model"}</h2>
        </header>
        {boxed && <Crop source={boxed} />}
        {boxed && (
          <div class="choice" role="group" aria-label="What to do">
            <button type="button" class="chip" aria-pressed={!isFollowed} onClick={() => setIsFollowed(false)}>
              Search for it everywhere
            </button>
            <button type="button" class="chip" aria-pressed={isFollowed} onClick={() => setIsFollowed(true)}>
              Follow it in this video
            </button>
          </div>
        )}
        {boxed && isFollowed ? (
          <div key="follow" class="fields">
            <p class="muted">
              It is followed from frame {boxed.frame.toLocaleString("en")} on, and back, as long as it can be seen. Then it is an object of the list, of the category boxed.
            </p>
            <label for="track-type">What it is, if you know</label>
            <input
              id="track-type"
              class="field"
              list="track-types"
              maxLength={40}
              autocomplete="off"
              placeholder="car, truck, person, …"
              value={type}
              onInput={(event) => setType(event.currentTarget.value)}
            />
            <datalist id="track-types">
              {TYPES.map((one) => (
                <option key={one} value={one} />
              ))}
            </datalist>
            <p class="muted">The usual size of such a thing gives its distance.</p>
          </div>
        ) : (
          <div key="model" class="fields">
            <p class="muted">
              {source && !("files" in source)
                ? `From what you boxed in frame ${source.frame.toLocaleString("en")}: it is found where it looks much as there.`
                : files.length > 1
                  ? `From ${files.length} photos.`
                  : `From ${first}.`}
            </p>
            {hasPhotos && <PhotoBoxes key={first} files={files} photos={photos} pictures={pictures} change={change} />}
            <label for="model-name">Name</label>
            <input
              id="model-name"
              ref={nameField}
              class="field"
              value={name}
              autocomplete="off"
              aria-invalid={name === ""}
              onInput={(event) => {
                event.currentTarget.value = cleanModelName(event.currentTarget.value);
                setName(event.currentTarget.value);
              }}
            />
            <label for="model-length">Length, if it is known (m)</label>
            <input
              id="model-length"
              class="field"
              type="number"
              min="0.01"
              step="any"
              value={length}
              onInput={(event) => setLength(event.currentTarget.value)}
            />
            <p class="muted">It gives distances, and with telemetry places.</p>
            {state.videos.value.length > 0 && (
              <label class="check">
                <input type="checkbox" checked={isSearched} onChange={(event) => setIsSearched(event.currentTarget.checked)} />
                Search all videos for it
              </label>
            )}
          </div>
        )}
        <div class="actions">
          <button class="button" type="button" onClick={() => (jobs.askedModel.value = null)}>
            Cancel
          </button>
          <button class="button primary" type="submit" disabled={!isValid && !(boxed && isFollowed)}>
            {boxed && isFollowed ? "Follow it" : "Make the model"}
          </button>
        </div>
      </form>
    </dialog>
  );
}

/** Files may be dropped anywhere on the page. */
export function DropTarget() {
  const [isOver, setIsOver] = useState(false);
  useEffect(() => {
    const holdsFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
    const over = (event: DragEvent) => {
      if (!holdsFiles(event)) return;
      event.preventDefault();
      setIsOver(true);
    };
    const leave = (event: DragEvent) => {
      if (event.relatedTarget === null) setIsOver(false);
    };
    const drop = (event: DragEvent) => {
      if (!holdsFiles(event)) return;
      event.preventDefault();
      setIsOver(false);
      jobs.addFiles([...(event.dataTransfer?.files ?? [])]);
    };
    window.addEventListener("dragover", over);
    window.addEventListener("dragleave", leave);
    window.addEventListener("drop", drop);
    return () => {
      window.removeEventListener("dragover", over);
      window.removeEventListener("dragleave", leave);
      window.removeEventListener("drop", drop);
    };
  }, []);
  if (!isOver) return null;
  return (
    <div class="drop-over" aria-hidden="true">
      <div>{jobs.canAdd.value ? "Drop a video, photos or a CAD file" : "This server takes no files"}</div>
    </div>
  );
}
