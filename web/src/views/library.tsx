// What the index has: its videos and models, each of which an administrator may take out again.
import { viewUrl } from "../api/client";
import { baseName, plural } from "../logic/format";
import * as library from "../library";
import * as state from "../state";
import { Swatch } from "./swatch";

function Remove({ name, ask }: { name: string; ask: () => void }) {
  if (!library.canRemove.value) return null;
  return (
    <button class="link" aria-label={`Remove ${name}`} onClick={ask}>
      Remove
    </button>
  );
}

export function Library() {
  const { videos, models, project } = state;
  if (videos.value.length + models.value.length === 0) return null;
  const hasViews = project.value.state === "ready" && project.value.value.has_views;
  return (
    <details class="library">
      <summary>
        In this index: {plural(videos.value.length, "video")}, {plural(models.value.length, "model")}
      </summary>
      <ul aria-label="Models of the index">
        {models.value.map((one) => (
          <li key={one.id} class="library-row">
            {hasViews && one.kind !== "category" && one.kind !== "boxed" ? <img src={viewUrl(one.id, 0)} alt="" width={40} height={40} loading="lazy" /> : <Swatch model={one.name} />}
            <strong title={one.name}>{one.name}</strong>
            <span class="muted">{plural(one.objects, "object")}</span>
            <Remove name={one.name} ask={() => library.askToRemoveModel(one)} />
          </li>
        ))}
      </ul>
      <ul aria-label="Videos of the index">
        {videos.value.map((one) => (
          <li key={one.id} class="library-row">
            <strong title={one.name}>{baseName(one.name)}</strong>
            <span class="muted">{plural(one.objects, "object")}</span>
            <Remove name={baseName(one.name)} ask={() => library.askToRemoveVideo(one)} />
          </li>
        ))}
      </ul>
    </details>
  );
}
