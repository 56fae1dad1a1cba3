// Videos and models are taken out of the index, after a question.
import { computed } from "@preact/signals";

import { postJob } from "./api/client";
import type { NewJob, Project, Video } from "./api/types";
import * as confirm from "./confirm";
import { canAdd } from "./jobs";
import { baseName, plural } from "./logic/format";
import * as notices from "./notices";
import { account } from "./session";

/** Without accounts, who opens the page has the rights of the server's user. */
export const canRemove = computed(() => canAdd.value && (account.value === null || account.value.role === "admin"));

export function askToRemoveVideo(video: Video) {
  confirm.ask({
    title: `Remove ${baseName(video.name)} from the index?`,
    text: `${lost(video.objects)} The file of the video stays.`,
    label: "Remove",
    run: () => void remove({ kind: "remove", video_id: video.id }),
  });
}

export function askToRemoveModel(model: Project["models"][number]) {
  confirm.ask({
    title: `Remove the model ${model.name}?`,
    text: `${lost(model.objects)} The model is deleted, and searched for no more.`,
    label: "Remove",
    run: () => void remove({ kind: "remove", model_id: model.id }),
  });
}

const lost = (objects: number) =>
  objects === 0 ? "Nothing was found of it." : `Its ${plural(objects, "object")}, and what was decided about them, are deleted. This cannot be taken back.`;

async function remove(job: NewJob) {
  try {
    await postJob(job);
  } catch (error) {
    notices.notifyError(error);
  }
}
