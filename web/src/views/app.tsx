// The page: header, three panes, inspector, and the keys.
import { useEffect } from "preact/hooks";

import { type Action, actionOf } from "../logic/keys";
import { pendingReviews } from "../objects";
import { needsLogIn, session } from "../session";
import * as grouping from "../grouping";
import * as jobs from "../jobs";
import * as reviews from "../reviews";
import * as selection from "../selection";
import * as state from "../state";
import * as turntable from "../turntable";
import * as why from "../why";
import * as workers from "../workers";
import * as zoom from "../zoom";
import { ConfirmDialog } from "./confirm";
import { Header } from "./header";
import { Help } from "./help";
import { Inspector } from "./inspector";
import { DropTarget, JobsPanel, ModelDialog } from "./jobs";
import { ObjectList } from "./list";
import { LogIn } from "./log_in";
import { MapPane } from "./map";
import { toggleDrawing } from "./map_area";
import { toggleMeasuring } from "./map_measure";
import { Notices } from "./notices";
import { PrintSheet } from "./print";
import { TurntableDialog } from "./turntable";
import { toggleBoxing, togglePlay, zoomToSelected } from "./stage";
import { VideoPane } from "./video";
import { WhyDialog } from "./why";
import { WorkersPanel } from "./workers";

const isTyping = (target: EventTarget | null) =>
  target instanceof HTMLElement && target.matches("input:not([type=range]), textarea, select");

function focus(id: string) {
  const field = document.getElementById(id);
  if (field instanceof HTMLInputElement || field instanceof HTMLTextAreaElement) {
    field.focus();
    field.select();
  }
}

function run(action: Action, shift: boolean) {
  switch (action) {
    case "next":
      return selection.step(1);
    case "previous":
      return selection.step(-1);
    case "nextMoment":
      return selection.stepMoment(1);
    case "previousMoment":
      return selection.stepMoment(-1);
    case "nextSighting":
      return void selection.stepSighting(1);
    case "previousSighting":
      return void selection.stepSighting(-1);
    case "mark":
      return reviews.toggleMark(state.selectedId.value);
    case "unmark":
      reviews.marked.value = new Set();
      return;
    case "join":
      return void grouping.joinMarked();
    case "accept":
      return reviews.decide("accepted");
    case "reject":
      return reviews.decide("rejected");
    case "reason":
      return; // useKeys() has given it
    case "note":
      return focus("note");
    case "why":
      return why.ask();
    case "turn":
      return turntable.openSelected();
    case "undo":
      return reviews.undo();
    case "play":
      return togglePlay();
    case "frameBack":
      return selection.stepFrame(shift ? -10 : -1);
    case "frameOn":
      return selection.stepFrame(shift ? 10 : 1);
    case "box":
      return toggleBoxing();
    case "zoomIn":
      return void zoom.zoomIn();
    case "zoomOut":
      return void zoom.zoomOut();
    case "whole":
      return void zoom.showWhole();
    case "native":
      return zoom.showNative();
    case "closeUp":
      return zoomToSelected();
    case "lens":
      zoom.hasLens.value = !zoom.hasLens.value;
      return;
    case "full":
      return zoom.setFull(!zoom.isFull.value);
    case "hide":
      state.isOverlayHidden.value = true;
      return;
    case "area":
      return toggleDrawing();
    case "measure":
      return toggleMeasuring();
    case "search":
      return focus("search");
    case "help":
      state.isHelpOpen.value = true;
      return;
    case "close":
      if (!state.isBoxing.value && !state.isDrawingArea.value && !state.isMeasuring.value) zoom.setFull(false);
      state.isMeasuring.value = false;
      state.isBoxing.value = false;
      state.isDrawingArea.value = false;
      jobs.isOpen.value = false;
      workers.isOpen.value = false;
      return;
  }
}

function useKeys() {
  useEffect(() => {
    const down = (event: KeyboardEvent) => {
      if (event.key === "Escape" && isTyping(event.target)) (event.target as HTMLElement).blur();
      // A dialog has the keys as long as it is open: its state follows a moment after it has closed.
      if (isTyping(event.target) || document.querySelector("dialog[open]") !== null || needsLogIn.value || event.defaultPrevented) return;
      const action = actionOf(event);
      if (action === null) return;
      // Space presses a focused button, arrows move a focused slider.
      const isOnControl = event.target instanceof HTMLElement && event.target.matches("button, input, [role=option]");
      if (isOnControl && event.key === " " && !event.target.matches("[role=option]")) return;
      if (event.target instanceof HTMLInputElement && event.key.startsWith("Arrow")) return;
      if (event.target instanceof HTMLElement && event.key.startsWith("Arrow") && event.target.closest(".maplibregl-map")) return;
      // Where no reason is asked for, these keys are nobody's.
      if (action === "reason" && !reviews.giveReason(event.key)) return;
      event.preventDefault();
      if (event.repeat && (action === "accept" || action === "reject")) return;
      run(action, event.shiftKey);
    };
    const show = (event: KeyboardEvent | FocusEvent) => {
      if (!(event instanceof KeyboardEvent) || event.key.toLowerCase() === "o") state.isOverlayHidden.value = false;
    };
    window.addEventListener("keydown", down);
    window.addEventListener("keyup", show);
    window.addEventListener("blur", show);
    return () => {
      window.removeEventListener("keydown", down);
      window.removeEventListener("keyup", show);
      window.removeEventListener("blur", show);
    };
  }, []);
}

/** The browser asks before it leaves a page whose reviews are not stored yet, also when another person logs in. */
function useUnloadGuard() {
  useEffect(() => {
    const guard = (event: BeforeUnloadEvent) => {
      if (pendingReviews.peek().size > 0) event.preventDefault();
    };
    window.addEventListener("beforeunload", guard);
    return () => window.removeEventListener("beforeunload", guard);
  }, []);
}

export function App() {
  useKeys();
  useUnloadGuard();
  // Before a log-in there is nothing to show, and nothing to ask the server for; later the page stays below the form.
  const isOpen = state.project.value.state === "ready" || (session.value !== null && !needsLogIn.value);
  return (
    <>
      {!state.isConnected.value && (
        <div class="lost" role="status">
          The server does not answer. What you decide is kept here and sent once it is back.
        </div>
      )}
      {isOpen && (
        <div class={`page ${state.isDrawingArea.value ? "drawing" : ""} ${zoom.isFull.value ? "full" : ""}`}>
          <Header />
          <main>
            <ObjectList />
            <VideoPane />
            <MapPane />
            <Inspector />
          </main>
          <JobsPanel />
          <WorkersPanel />
          <Notices />
        </div>
      )}
      <ModelDialog />
      <ConfirmDialog />
      <WhyDialog />
      <TurntableDialog />
      <DropTarget />
      {!isOpen && <Notices />}
      <Help />
      <LogIn />
      {isOpen && <PrintSheet />}
    </>
  );
}
