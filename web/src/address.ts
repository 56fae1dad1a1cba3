// The address bar follows the selection.
import { effect } from "@preact/signals";

import { formatUrl } from "./logic/url_state";
import { filters, isPlaying, project, selectedId, shownFrame, shownTime, videoId } from "./state";

let urlTimer: ReturnType<typeof setTimeout> | undefined;

/** @param push  Back returns to what the bar holds now */
export function writeUrl(push: boolean) {
  const url = formatUrl({ object: selectedId.value, video: videoId.value, time: shownTime.value, area: filters.value.area });
  if (url === location.search) return;
  if (push) history.pushState(null, "", url || location.pathname);
  else history.replaceState(null, "", url || location.pathname);
}

effect(() => {
  // Not for each frame that plays.
  void shownFrame.value;
  void selectedId.value;
  void filters.value.area;
  if (project.value.state !== "ready" || isPlaying.value) return;
  clearTimeout(urlTimer);
  urlTimer = setTimeout(() => writeUrl(false), 250);
});
