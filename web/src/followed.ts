// Objects that were boxed in the video that is shown and followed through it: the results of jobs of the kind "track".
import { computed, effect, signal, untracked } from "@preact/signals";

import { getTrack } from "./api/client";
import { type FollowedRow, type Followed, momentsOf, nameOf } from "./logic/followed";
import { jobs } from "./jobs";
import { notifyError } from "./notices";
import { videoId } from "./state";

const loaded = signal<ReadonlyMap<number, readonly FollowedRow[]>>(new Map());
const asked = new Set<number>();
/** Jobs whose tracks the user does not want to see. */
const hidden = signal<ReadonlySet<number>>(new Set());

const ready = computed(() =>
  jobs.value.filter(
    (one) => one.kind === "track" && one.files.includes("track") && one.video_id === videoId.value && !hidden.value.has(one.id),
  ),
);

async function load(job: number) {
  asked.add(job);
  try {
    loaded.value = new Map(loaded.peek()).set(job, await getTrack(job));
  } catch (error) {
    asked.delete(job);
    notifyError(error);
  }
}

effect(() => {
  const wanted = ready.value;
  untracked(() => {
    for (const one of wanted) if (!asked.has(one.id)) void load(one.id);
  });
});

/** Of the video that is shown, oldest first. */
export const followed = computed((): readonly Followed[] =>
  ready.value
    .flatMap((job) => {
      const rows = loaded.value.get(job.id);
      return rows ? [{ job: job.id, name: nameOf(job.title), rows, moments: momentsOf(rows), byFrame: new Map(rows.map((one) => [one.frame, one])) }] : [];
    })
    .sort((a, b) => a.job - b.job),
);

export function hide(job: number) {
  hidden.value = new Set([...hidden.value, job]);
}
