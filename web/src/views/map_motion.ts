// A browser without a GPU draws the map in software, and its main thread waits for each picture: a quarter of the pixels
// takes less than half of the time. So the map is coarse there while it is dragged or zoomed, and sharp once it rests.
import type { Map as MapLibre } from "maplibre-gl";

import { isSoftware } from "../logic/renderer";

/** Of the pixels along an edge. */
const COARSE = 0.5;

function rendererOf(map: MapLibre): string {
  const gl = map.getCanvas().getContext("webgl2");
  if (!gl) return "";
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
}

/** Returns a function that ends it. */
export function coarsenMotion(map: MapLibre): () => void {
  if (!isSoftware(rendererOf(map))) return () => {};
  const container = map.getCanvasContainer();
  let isCoarse = false;
  let isHeld = false;
  const set = (coarse: boolean) => {
    isCoarse = coarse;
    map.setPixelRatio(window.devicePixelRatio * (coarse ? COARSE : 1));
  };
  // Before the map begins to move: another size would end a drag.
  const begin = () => {
    if (!isCoarse && !map.isMoving()) set(true);
  };
  const drag = (event: PointerEvent) => {
    if (event.buttons === 0) return;
    isHeld = true;
    begin();
  };
  const release = () => {
    isHeld = false;
    if (isCoarse) map.triggerRepaint();
  };
  const rest = () => {
    if (isCoarse && !isHeld) set(false);
  };
  map.on("idle", rest);
  container.addEventListener("wheel", begin, { capture: true, passive: true });
  container.addEventListener("pointermove", drag, { capture: true });
  window.addEventListener("pointerup", release);
  window.addEventListener("pointercancel", release);
  return () => {
    map.off("idle", rest);
    container.removeEventListener("wheel", begin, { capture: true });
    container.removeEventListener("pointermove", drag, { capture: true });
    window.removeEventListener("pointerup", release);
    window.removeEventListener("pointercancel", release);
  };
}
