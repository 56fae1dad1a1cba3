// The panel of workers: how many tasks wait, run and have failed, how long yet, who does what, and frames that are left
// out.
import type { ComponentChildren } from "preact";

import type { Cluster, ClusterSource, ClusterTask } from "../api/types";
import { DASH, baseName, formatSpan, plural } from "../logic/format";
import { formatLeft } from "../logic/uploads";
import { describeBehind, describePart, describeRate, formatFrames, formatSilence, formatUtcGap, isLate } from "../logic/workers";
import * as workers from "../workers";
import { Icon } from "./icons";

export function WorkersButton() {
  const cluster = workers.cluster.value;
  if (!cluster) return null;
  return (
    <button class="button jobs-button" aria-expanded={workers.isOpen.value} onClick={workers.toggle}>
      {cluster.workers > 0 ? plural(cluster.workers, "worker") : "Workers"}
    </button>
  );
}

const STATES = ["queued", "waiting", "running", "done", "failed"] as const;

function Counts({ cluster }: { cluster: Cluster }) {
  const { segments } = cluster;
  const isCut = STATES.some((state) => segments[state] > 0);
  const row = (name: string, counts: Cluster["videos"]) => (
    <tr>
      <th scope="row">{name}</th>
      {STATES.map((state) => (
        <td key={state} class={counts[state] === 0 ? "none" : state}>
          {counts[state].toLocaleString("en")}
        </td>
      ))}
    </tr>
  );
  return (
    <table class="task-counts">
      <thead>
        <tr>
          <td />
          {STATES.map((state) => (
            <th key={state} scope="col" title={state === "waiting" ? "for their segments" : undefined}>
              {state}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {row("Videos", cluster.videos)}
        {isCut && row("Segments", segments)}
      </tbody>
    </table>
  );
}

function Rate({ cluster }: { cluster: Cluster }) {
  const open = STATES.slice(0, 3).some((state) => cluster.videos[state] > 0);
  if (!open) return null;
  return (
    <dl class="task-rate">
      <dt>Rate</dt>
      <dd title="By the time that the last tasks took">{describeRate(cluster) ?? `${DASH} (no task of this kind was done yet)`}</dd>
      <dt>Time left</dt>
      <dd>{cluster.left_s === null ? `${DASH} (known once the queued videos are cut)` : formatLeft(cluster.left_s).replace(/ left$/, "")}</dd>
    </dl>
  );
}

function Part({ title, children }: { title: string; children: ComponentChildren }) {
  return (
    <section>
      <h3>{title}</h3>
      <ul>{children}</ul>
    </section>
  );
}

function Row({ video, note, isFailed = false, children }: { video: string; note: string; isFailed?: boolean; children: ComponentChildren }) {
  return (
    <li class={`job ${isFailed ? "failed" : ""}`}>
      <div class="job-head">
        <strong title={video}>{baseName(video) || "not a valid task"}</strong>
        <span class="muted">{note}</span>
      </div>
      <div class="job-state">{children}</div>
    </li>
  );
}

function Running({ task }: { task: ClusterTask }) {
  return (
    <Row video={task.video} note={describePart(task)}>
      {task.worker}
      {task.silent_s !== null && ", "}
      <span class={isLate(task) ? "late" : ""}>{formatSilence(task.silent_s)}</span>
      {task.attempt > 1 && `, attempt ${task.attempt}`}
      {task.reason !== "" && `; before: ${task.reason}`}
    </Row>
  );
}

const MAX_GAPS = 5;

function Source({ source }: { source: ClusterSource }) {
  const isRunning = source.state === "running";
  const gaps = source.gaps.slice(-MAX_GAPS);
  return (
    <Row video={source.source} note={describeBehind(source)} isFailed={source.state === "failed"}>
      {isRunning ? source.worker : `no worker (${source.state})`}
      {isRunning && source.silent_s !== null && ", "}
      {isRunning && <span class={isLate(source) ? "late" : ""}>{formatSilence(source.silent_s)}</span>}
      {source.attempt > 1 && `, attempt ${source.attempt}`}
      {source.reason !== "" && `; last: ${source.reason}`}
      {gaps.length > 0 && (
        <div class="late">
          {`${plural(source.gaps.length, "gap")}: ${gaps.length < source.gaps.length ? "… " : ""}${gaps.map(formatUtcGap).join(", ")}`}
        </div>
      )}
    </Row>
  );
}

export function WorkersPanel() {
  const cluster = workers.cluster.value;
  if (!cluster || !workers.isOpen.value) return null;
  const running = cluster.tasks.filter((task) => task.state === "running");
  const failed = cluster.tasks.filter((task) => task.state === "failed");
  return (
    <aside class="jobs workers" aria-label="Workers">
      <header>
        <h2>Workers</h2>
        <button class="button icon plain" aria-label="Close" onClick={workers.toggle}>
          <Icon name="close" />
        </button>
      </header>
      <Counts cluster={cluster} />
      <Rate cluster={cluster} />
      {cluster.sources.length > 0 && (
        <Part title="Live">
          {cluster.sources.map((source) => (
            <Source key={source.id} source={source} />
          ))}
        </Part>
      )}
      {running.length > 0 && (
        <Part title={plural(cluster.workers, "worker")}>
          {running.map((task) => (
            <Running key={task.id} task={task} />
          ))}
        </Part>
      )}
      {failed.length > 0 && (
        <Part title="Failed">
          {failed.map((task) => (
            <Row key={task.id} video={task.video} note={task.segment ? formatFrames(task.segment) : ""} isFailed>
              {task.reason}
            </Row>
          ))}
        </Part>
      )}
      {cluster.quarantined.length > 0 && (
        <Part title="Will be left out">
          {cluster.quarantined.map((one) => (
            <Row key={`${one.video} ${one.segment[0]}`} video={one.video} note={formatFrames(one.segment)} isFailed>
              {one.reason}
            </Row>
          ))}
        </Part>
      )}
      {cluster.gaps.length > 0 && (
        <Part title="Left out">
          {cluster.gaps.map((gap) => (
            <Row key={`${gap.video} ${gap.segment[0]}`} video={gap.video} note={formatSpan(gap.from_s, gap.to_s)} isFailed>
              {`${formatFrames(gap.segment)}: ${gap.reason}`}
            </Row>
          ))}
        </Part>
      )}
      {cluster.workers === 0 && (
        <p class="muted">
          No worker has a task. <code>victorious submit</code> queues videos, <code>victorious work</code> starts a worker.
        </p>
      )}
    </aside>
  );
}
