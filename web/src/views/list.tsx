// The ranked list: a queue to be worked off by keys. Only the visible rows are in the document.
import { Virtualizer, elementScroll, observeElementOffset, observeElementRect } from "@tanstack/virtual-core";
import { computed, signal } from "@preact/signals";
import { useEffect, useLayoutEffect, useReducer, useRef, useState } from "preact/hooks";

import { thumbnailUrl } from "../api/client";
import type { FoundObject } from "../api/types";
import { describeDecisions, summarise } from "../logic/decisions";
import { searchedHours } from "../logic/coverage";
import { NO_FILTERS, type ReviewFilter, isChosen, isFiltered, parseQuery } from "../logic/filters";
import { baseName, explainScore, formatExpected, formatMetres, formatScore, plural } from "../logic/format";
import { lookOf } from "../logic/grouping";
import { describeSeen, summarizeSeen } from "../logic/moments";
import { type ChoosableModel, findModels, modelsWithChips } from "../logic/model_choice";
import type { PagedList } from "../logic/paged_list";
import { thresholdCost } from "../logic/threshold_cost";
import { isBelow, isWeak } from "../logic/weak";
import * as grouping from "../grouping";
import * as jobs from "../jobs";
import * as load from "../load";
import { me } from "../me";
import * as notices from "../notices";
import * as objects from "../objects";
import { printList } from "../print";
import { isRegrouping } from "../regroup";
import * as reviews from "../reviews";
import * as save from "../save";
import * as selection from "../selection";
import * as state from "../state";
import { FirstSteps } from "./first_steps";
import { Icon } from "./icons";
import { Learnt } from "./learnt";
import { Menu } from "./menu";
import { Picture } from "./picture";
import { Swatch } from "./swatch";

const ROW_HEIGHT = 80;

const hours = computed(() => {
  const { video } = state.filters.value;
  return searchedHours(state.videos.value.filter((one) => video === null || one.id === video));
});
const cost = computed(() => {
  const counts = objects.countsOfAnyScore.value ?? objects.counts.value;
  return counts === null ? { rejected: 0, falseAlarms: 0, misses: 0 } : thresholdCost(counts, state.filters.value.minScore);
});
/** What the cost of a threshold counts. */
const COST = [
  "Of the objects that match the other filters.",
  "What nobody has decided counts by its score, the probability that it is real; what is accepted counts as real, what is rejected as a false alarm.",
  "An hour is one of video that was searched.",
].join(" ");

function useVirtualizer(count: number) {
  const scroller = useRef<HTMLDivElement>(null);
  const [, rerender] = useReducer((n: number) => n + 1, 0);
  const options = {
    count,
    getScrollElement: () => scroller.current,
    estimateSize: () => ROW_HEIGHT,
    overscan: 6,
    observeElementRect,
    observeElementOffset,
    scrollToFn: elementScroll,
    onChange: () => rerender(undefined),
  };
  const [virtualizer] = useState(() => new Virtualizer<HTMLDivElement, HTMLDivElement>(options));
  virtualizer.setOptions(options);
  useLayoutEffect(() => virtualizer._didMount(), [virtualizer]);
  useLayoutEffect(() => virtualizer._willUpdate());
  return { scroller, virtualizer };
}

/** The team's verdict; who decided, where the reader has not. */
export function VerdictMark({ object }: { object: FoundObject }) {
  const summary = summarise(object, me.value);
  if (!summary) return null;
  const { verdict, text, isOthers } = summary;
  const isPending = objects.pendingReviews.value.has(object.id);
  const icon = object.is_disputed ? "disputed" : verdict === "accepted" ? "accept" : "reject";
  return (
    <span
      class={`verdict ${verdict} ${isPending ? "pending" : ""} ${object.is_disputed ? "disputed" : ""} ${isOthers ? "others" : ""}`}
      title={describeDecisions(object, me.value)}
    >
      <Icon name={icon} />
      {isOthers && text !== verdict && <span class="hidden">{verdict} by </span>}
      <span class="who">{isPending ? "saving" : text}</span>
    </span>
  );
}

/** Where the list has little height they are folded (app.css); elsewhere they are always shown. */
const areFiltersOpen = signal(false);

function Row({ object, before, index, top, total }: { object: FoundObject; before: FoundObject | undefined; index: number; top: number; total: number }) {
  const isSelected = state.selectedId.value === object.id;
  const isMarked = reviews.marked.value.has(object.id);
  const place = object.place;
  const accuracy = place ? `± ${formatMetres(place.ce90_m)}` : "no place";
  const seen = state.seenOf(object);
  const areSeveral = state.videos.value.length > 1;
  const weak = isWeak(object, state.categoryNames.value);
  const isFirstBelow = state.sort.value === "rank" && isBelow(before, object);
  return (
    <div
      id={`object-${object.id}`}
      role="option"
      aria-selected={isSelected}
      aria-posinset={index + 1}
      aria-setsize={total}
      class={`row ${state.matcher.value(object) ? "" : "greyed"} ${isMarked ? "marked" : ""} ${isFirstBelow ? "first-below" : ""}`}
      style={{ transform: `translateY(${top}px)` }}
      onClick={(event) => {
        const from = state.selectedId.value;
        if (event.shiftKey && from !== null) reviews.markRange(from, object.id);
        else if (event.ctrlKey || event.metaKey) reviews.toggleMark(object.id);
        else selection.select(object.id, { push: true });
      }}
    >
      <div class="thumb">
        {isMarked && <span class="mark"><Icon name="accept" /></span>}
        <Picture src={thumbnailUrl(object.id, 168, lookOf(object))} alt="" width={84} height={63} />
      </div>
      <div class="lines">
        <div class="line">
          <div class="name">
            <Swatch model={object.model} />
            <span>{object.model}</span>
          </div>
          <span class="score" title={explainScore(object.score)}>
            {weak && <span class="weak" title="More likely false than right">weak</span>} {formatScore(object.score)}
          </span>
        </div>
        <div class="line">
          <div class="facts" title={seen.length > 1 ? seen.map(describeSeen).join("\n") : undefined}>
            {summarizeSeen(seen, state.videoId.value)}
          </div>
          <span class="facts">{areSeveral ? accuracy : plural(object.frames, "frame")}</span>
        </div>
        <div class="line">
          <div class="facts where" title={areSeveral ? seen.map((one) => one.video).join("\n") : undefined}>
            {!areSeveral ? accuracy : seen.length === 1 ? baseName(seen[0]?.video ?? "") : plural(seen.length, "video")}
          </div>
          <VerdictMark object={object} />
        </div>
      </div>
    </div>
  );
}

type ReviewChip = [ReviewFilter, string, string];
const VERDICTS: readonly ReviewChip[] = [
  ["none", "to review", "Nobody has decided"],
  ["accepted", "accepted", "By the team: the latest decision"],
  ["rejected", "rejected", "By the team: the latest decision"],
];
const PERSONS: readonly ReviewChip[] = [
  ["own", "by you", "You have decided"],
  ["not_own", "not by you", "You have not decided, whether others have or not"],
  ["disputed", "disputed", "Some accepted it, some rejected it"],
];

function ReviewChips({ label, chips }: { label: string; chips: readonly ReviewChip[] }) {
  const { review } = state.filters.value;
  return (
    <div class="chip-group" role="group" aria-label={label}>
      {chips.map(([one, text, title]) => (
        <button key={one} class="chip" title={title} aria-pressed={review === one} onClick={() => state.setFilters({ review: review === one ? "all" : one })}>
          {text}
        </button>
      ))}
    </div>
  );
}

/** All models, to be searched by name. */
function ModelChoice({ all, toggle }: { all: readonly ChoosableModel[]; toggle: (name: string) => void }) {
  const [text, setText] = useState("");
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => field.current?.focus(), []);
  const { models } = state.filters.value;
  const found = findModels(all, text);
  return (
    <div id="all-models" class="model-choice" role="group" aria-label="All models">
      <label class="hidden" for="model-search">
        Part of a model's name
      </label>
      <input
        id="model-search"
        class="field"
        type="search"
        autocomplete="off"
        placeholder="Part of a name"
        ref={field}
        value={text}
        onInput={(event) => setText(event.currentTarget.value)}
      />
      <ul tabIndex={0} aria-label="Models">
        {found.map(({ name, objects: count }) => (
          <li key={name}>
            <label class="check">
              <input type="checkbox" checked={models.includes(name)} onChange={() => toggle(name)} />
              <Swatch model={name} />
              <span class="name">{name}</span>
              <span class="muted">{count.toLocaleString("en")}</span>
            </label>
          </li>
        ))}
      </ul>
      {found.length === 0 && <p class="muted">No model has this in its name.</p>}
    </div>
  );
}

function ModelChips() {
  const { models } = state.filters.value;
  const [isChoosing, setIsChoosing] = useState(false);
  const all = state.models.value;
  const shown = modelsWithChips(all, models);
  if (all.length < 2) return null;
  const toggle = (name: string) =>
    state.setFilters({ models: models.includes(name) ? models.filter((one) => one !== name) : [...models, name] });
  return (
    <div class="chip-group" role="group" aria-label="Models">
      {shown.map(({ name }) => (
        <button key={name} class="chip" aria-pressed={models.includes(name)} onClick={() => toggle(name)}>
          <Swatch model={name} />
          {name}
        </button>
      ))}
      {shown.length < all.length && (
        <button class="chip" aria-expanded={isChoosing} aria-controls="all-models" onClick={() => setIsChoosing(!isChoosing)}>
          all {all.length} models <span aria-hidden="true">▾</span>
        </button>
      )}
      {isChoosing && <ModelChoice all={all} toggle={toggle} />}
    </div>
  );
}

function Chips() {
  const { video, area } = state.filters.value;
  return (
    <div class="chips" role="group" aria-label="Filters">
      <ModelChips />
      <ReviewChips label="Verdicts" chips={VERDICTS} />
      <div class="chip-row">
        <ReviewChips label="Persons" chips={PERSONS} />
        {(area !== null || state.videos.value.length > 1) && (
          <div class="chip-group" role="group" aria-label="Where">
            {area !== null && (
              <button class="chip" aria-pressed title="Drawn on the map. Click: everywhere again" onClick={() => state.setFilters({ area: null })}>
                in the area <Icon name="close" />
              </button>
            )}
            {state.videos.value.length > 1 && (
              <button class="chip" aria-pressed={video !== null} onClick={() => state.setFilters({ video: video === null ? state.videoId.value : null })}>
                this video
              </button>
            )}
          </div>
        )}
      </div>
    </div>
  );
}

function Threshold() {
  const { minScore } = state.filters.value;
  const { rejected, falseAlarms, misses } = cost.value;
  // Of less than a minute, an hour says nothing.
  const isLong = hours.value >= 1 / 60;
  const perHour = (count: number) => (isLong ? ` (${formatExpected(count / hours.value)} an hour)` : "");
  return (
    <div class="threshold">
      <label for="threshold">Score</label>
      <input
        id="threshold"
        type="range"
        min="0"
        max="1"
        step="0.01"
        value={minScore}
        aria-valuetext={`at least ${minScore.toFixed(2)}`}
        onInput={(event) => state.setFilters({ minScore: Number(event.currentTarget.value) })}
      />
      <output for="threshold">≥ {minScore.toFixed(2)}</output>
      <span class="cost" title={COST}>
        <span>
          {rejected > 0 ? `${rejected.toLocaleString("en")} rejected; about ${formatExpected(falseAlarms)} further false alarms` : `about ${formatExpected(falseAlarms)} false alarms shown`}
          {perHour(rejected + falseAlarms)}
        </span>
        <span>
          about {formatExpected(misses)} real objects hidden{perHour(misses)}
        </span>
      </span>
    </div>
  );
}

/** Where the filters exclude what is selected, the list shows the first object that they do not. */
function useFirstMatch(list: PagedList, virtualizer: Virtualizer<HTMLDivElement, HTMLDivElement>) {
  const { filters, isOnlyMatching, selected } = state;
  const chosen = filters.value;
  useEffect(() => {
    const object = selected.peek();
    if (!isChosen(chosen) || (object !== null && state.matcher.peek()(object))) return;
    if (isOnlyMatching.peek()) return virtualizer.scrollToIndex(0);
    let isOver = false;
    // Not for each letter that is typed.
    const timer = setTimeout(() => {
      selection
        .neighbour(1, chosen, null)
        .then(async (id) => {
          if (id === null || isOver) return;
          if (list.positionOf(id) === undefined) await objects.locate(id);
          const position = list.positionOf(id);
          if (position !== undefined) virtualizer.scrollToIndex(position, { align: "start" });
        })
        .catch(notices.notifyError);
    }, 200);
    return () => {
      isOver = true;
      clearTimeout(timer);
    };
  }, [chosen, list, virtualizer]);
}

function Rows({ list }: { list: PagedList }) {
  const { scroller, virtualizer } = useVirtualizer(list.total);
  void objects.listVersion.value;
  const selected = state.selectedId.value;
  const position = selected === null ? undefined : list.positionOf(selected);
  useEffect(() => {
    if (position !== undefined) virtualizer.scrollToIndex(position, { align: "auto" });
    else if (selected !== null) objects.locate(selected).catch(notices.notifyError);
  }, [selected, virtualizer, list, position !== undefined]);
  useFirstMatch(list, virtualizer);
  const items = virtualizer.getVirtualItems();
  const [first, last] = [items[0]?.index ?? 0, items.at(-1)?.index ?? 0];
  // Only rows near those that are seen are elements of the page; the filters may leave the selected one out.
  const isDrawn = selected !== null && objects.objectOf(selected) !== undefined && items.some((one) => list.at(one.index) === selected);
  useEffect(() => {
    // Not the pages that a fast scroll only passes.
    const timer = setTimeout(() => objects.need(first, last, notices.notifyError), 60);
    return () => clearTimeout(timer);
  }, [list, first, last]);
  return (
    <div
      class="rows"
      ref={scroller}
      role="listbox"
      tabIndex={0}
      aria-label="Objects"
      aria-activedescendant={isDrawn ? `object-${selected}` : undefined}
      onKeyDown={(event) => {
        if (event.key === "ArrowDown" || event.key === "ArrowUp") selection.step(event.key === "ArrowDown" ? 1 : -1);
        else if (event.key === "Home" || event.key === "End") selection.stepToEnd(event.key === "Home" ? "first" : "last");
        else return;
        event.preventDefault();
      }}
    >
      <div role="presentation" style={{ height: virtualizer.getTotalSize(), position: "relative" }}>
        {items.map((item) => {
          const id = list.at(item.index);
          const object = id === undefined ? undefined : objects.objectOf(id);
          const previous = list.at(item.index - 1);
          const before = previous === undefined ? undefined : objects.objectOf(previous);
          if (object) return <Row key={id} object={object} before={before} index={item.index} top={item.start} total={list.total} />;
          return (
            <div key={`at-${item.index}`} class="row" aria-busy="true" style={{ transform: `translateY(${item.start}px)` }}>
              <div class="thumb skeleton" />
              <div class="skeleton" style={{ height: "2.2em" }} />
            </div>
          );
        })}
      </div>
    </div>
  );
}

const SORTS: [objects.Sort, string][] = [
  ["queue", "To review first"],
  ["rank", "Best first"],
  ["newest", "Newest first"],
];

function Order() {
  return (
    <div class="order">
      <label class="hidden" for="sort">
        Order
      </label>
      <select
        id="sort"
        class="field"
        value={state.sort.value}
        onChange={(event) => (state.sort.value = event.currentTarget.value as objects.Sort)}
      >
        {SORTS.map(([value, text]) => (
          <option key={value} value={value}>
            {text}
          </option>
        ))}
      </select>
      <button
        class="chip"
        aria-pressed={state.isOnlyMatching.value}
        title="Leave out of the list what the filters exclude, instead of greying it out"
        onClick={() => (state.isOnlyMatching.value = !state.isOnlyMatching.value)}
      >
        matches only
      </button>
    </div>
  );
}

function Save() {
  return (
    <Menu
      label="Save"
      title="Save or print the objects that match the filters"
      items={[
        { label: "Table (CSV)", choose: () => void save.saveList("csv") },
        { label: "Moments by video (CSV)", choose: () => void save.saveList("moments") },
        { label: "Map (GeoJSON)", choose: () => void save.saveList("geojson") },
        { label: "Map (KML)", choose: () => void save.saveList("kml") },
        { label: "Map (GeoPackage)", choose: () => void save.savePackage() },
        { label: "Print map and list", choose: () => void printList() },
      ]}
    />
  );
}

/** What a place in the search field lacks, or what is taken for granted. */
function SearchHint() {
  const { hint } = parseQuery(state.filters.value.text);
  return (
    <p class="hint" role="status" hidden={hint === null}>
      {hint}
    </p>
  );
}

function Nothing() {
  const isSearched = state.videos.value.some((one) => one.searched_s > 0) && !jobs.active.value.some((one) => one.kind === "index");
  // Before there is a video, the pane of the video has more room for them.
  if (!isSearched && jobs.canAdd.value) return state.videos.value.length > 0 ? <FirstSteps /> : <p class="empty">The finds appear here.</p>;
  return (
    <div class="empty">
      <h3>{state.videos.value.length === 0 ? "No video yet" : "Nothing found yet"}</h3>
      {!isSearched ? (
        <>
          <p>The finds appear here once a video is searched.</p>
          {!jobs.canAdd.value && <p>{jobs.whyNotAdd()}</p>}
        </>
      ) : (
        <>
          <p>No model was recognised in the videos that were searched. Not found are objects of less than some 40 pixels, and sides that no photo of the model shows.</p>
          {jobs.canAdd.value && <p>Can you see the object in the video? Box it there (B), and search for what it looks like.</p>}
        </>
      )}
    </div>
  );
}

function Loading() {
  return (
    <div class="rows" aria-busy="true" aria-label="Loading">
      {Array.from({ length: 8 }, (_, i) => (
        <div key={i} class="row" style={{ position: "relative" }}>
          <div class="thumb skeleton" />
          <div class="skeleton" style={{ height: "2.2em" }} />
        </div>
      ))}
    </div>
  );
}

/** The marked objects are one. */
function Join() {
  const whyNot = grouping.whyNotJoinMarked.value;
  const isBusy = isRegrouping.value;
  // Pressed by key, it hands the focus on to the list when it goes.
  const join = async (isByKey: boolean) => {
    await grouping.joinMarked();
    if (isByKey && reviews.marked.peek().size === 0) document.querySelector<HTMLElement>(".list .rows")?.focus();
  };
  return (
    <button
      class="button"
      aria-disabled={whyNot !== null || isBusy}
      title={whyNot ?? "They are one object (G)"}
      onClick={(event) => void join(event.detail === 0)}
    >
      Join
    </button>
  );
}

function Marked() {
  return (
    <div class="marked-bar" role="group" aria-label="Marked objects">
      <strong>{reviews.marked.value.size.toLocaleString("en")} marked</strong>
      <button class="button" onClick={() => reviews.decide("accepted")}>
        Accept
      </button>
      <button class="button" onClick={() => reviews.decide("rejected")}>
        Reject
      </button>
      {state.canReview.value && reviews.marked.value.size > 1 && <Join />}
      <button class="link" onClick={() => (reviews.marked.value = new Set())}>
        Clear
      </button>
    </div>
  );
}

function Empty() {
  return (
    <div class="empty">
      <h3>No object matches</h3>
      <button class="button" onClick={clearFilters}>
        Clear filters
      </button>
    </div>
  );
}

const clearFilters = () => state.setFilters({ ...NO_FILTERS, thresholds: state.filters.value.thresholds });

export function ObjectList() {
  const project = state.project.value;
  const list = objects.list.value;
  const known = objects.counts.value;
  const all = known?.objects ?? 0;
  const hasLess = isFiltered(state.filters.value);
  const shown = objects.matching.value;
  const isNew = objects.listedAll.value !== null && all > objects.listedAll.value;
  return (
    <section class="list" aria-label="Objects found">
      <div class="above">
        <div class="count">
          <h2>
            {hasLess ? `${shown === null ? "…" : shown.toLocaleString("en")} of ${plural(all, "object")}` : known ? plural(all, "object") : "…"}
          </h2>
          {isChosen(state.filters.value) && (
            <button class="link" onClick={clearFilters}>
              Clear filters
            </button>
          )}
          <button
            class="chip filters-button"
            aria-expanded={areFiltersOpen.value}
            aria-controls="filters"
            onClick={() => (areFiltersOpen.value = !areFiltersOpen.value)}
          >
            Filters
          </button>
          {all > 0 && <Save />}
        </div>
        <SearchHint />
        {reviews.marked.value.size > 0 && <Marked />}
        {isNew && (
          <button class="button new" onClick={() => void load.showNew()}>
            {plural(all - (objects.listedAll.value ?? all), "new object")}: show
          </button>
        )}
        {!isNew && objects.isListOld.value && !isRegrouping.value && (
          <button class="button new" onClick={() => void load.showNew()}>
            Objects of the list have changed: show
          </button>
        )}
        <div id="filters" class="filters" data-open={areFiltersOpen.value}>
          <Chips />
          {all > 0 && <Order />}
          {all > 0 && <Threshold />}
          {all > 0 && <Learnt />}
        </div>
      </div>
      {project.state === "loading" && <Loading />}
      {project.state === "failed" && (
        <div class="empty" role="alert">
          <h3>The index cannot be shown</h3>
          <p>{project.message}</p>
          <p>It is tried again every few seconds.</p>
        </div>
      )}
      {project.state === "ready" && list && (all === 0 ? <Nothing /> : list.total === 0 ? <Empty /> : <Rows list={list} />)}
    </section>
  );
}
