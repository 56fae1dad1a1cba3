// The address bar follows the selection.
import { effect } from "@preact/signals";

import { formatUrl } from "./logic/url_state";
import { detail, filters, isOnlyMatching, isPlaying, project, selectedId, shownFrame, shownTime, sort, videoId } from "./state";

let urlTimer: ReturnType<typeof setTimeout> | undefined;

/** The key of the selected object; its id, as long as the key is not known. */
function selectedName() {
  const known = detail.value;
  const isKnown = known?.state === "ready" && known.value.id === selectedId.value;
  return (isKnown ? known.value.key : null) ?? selectedId.value;
}

/** @param push  Back returns to what the bar holds now */
export function writeUrl(push: boolean) {
  const url = formatUrl({
    object: selectedName(),
    video: videoId.value,
    time: shownTime.value,
    filters: filters.value,
    order: sort.value,
    isAllListed: !isOnlyMatching.value,
  });
  if (url === location.search) return;
  if (push) history.pushState(null, "", url || location.pathname);
  else history.replaceState(null, "", url || location.pathname);
}

effect(() => {
  // Not for each frame that plays.
  void shownFrame.value;
  void selectedId.value;
  void detail.value;
  void filters.value;
  void sort.value;
  void isOnlyMatching.value;
  if (project.value.state !== "ready" || isPlaying.value) return;
  clearTimeout(urlTimer);
  urlTimer = setTimeout(() => writeUrl(false), 250);
});
