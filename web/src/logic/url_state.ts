// The selection, the filters and the order of the list in the address bar, so that a find can be sent to a colleague, a reload
// finds again what was set, and Back works.

import { formatArea, parseArea } from "./area";
import { type Filters, NO_FILTERS, type ReviewFilter } from "./filters";

/** Filters that the reader chose; thresholds are the team's. */
export type ChosenFilters = Omit<Filters, "thresholds">;
export type Order = "queue" | "rank" | "newest";

const REVIEWS: readonly ReviewFilter[] = ["none", "accepted", "rejected", "own", "not_own", "disputed"];
const ORDERS: readonly Order[] = ["queue", "rank", "newest"];

export interface UrlState {
  /** The object's key, which outlives a new search; its id, as in older links, where it has none. */
  object: string | number | null;
  video: number | null;
  /** s */
  time: number | null;
  filters: ChosenFilters;
  order: Order;
  /** The list greys out what the filters exclude, instead of leaving it out. */
  isAllListed: boolean;
}



function number(text: string | null): number | null {
  if (text === null || text.trim() === "") return null;
  const value = Number(text);
  return Number.isFinite(value) && value >= 0 ? value : null;
}

function notFiltered(): ChosenFilters {
  const { text, models, video, review, minScore, area } = NO_FILTERS;
  return { text, models, video, review, minScore, area };
}

/** What an address without parameters says. */
export const PLAIN: UrlState = { object: null, video: null, time: null, filters: notFiltered(), order: "queue", isAllListed: false };

export function parseUrl(search: string): UrlState {
  const query = new URLSearchParams(search);
  const whole = (name: string) => {
    const value = number(query.get(name));
    return value !== null && Number.isInteger(value) ? value : null;
  };
  // A key has dots.
  const key = query.get("object");
  const object = whole("object") ?? (key !== null && key.includes(".") ? key : null);
  const least = number(query.get("min")) ?? 0;
  return {
    object,
    video: whole("video"),
    time: number(query.get("t")),
    filters: {
      text: query.get("q") ?? "",
      models: query.getAll("model"),
      video: whole("in"),
      review: REVIEWS.find((one) => one === query.get("review")) ?? "all",
      minScore: least <= 1 ? least : 0,
      area: parseArea(query.get("area") ?? ""),
    },
    order: ORDERS.find((one) => one === query.get("order")) ?? "queue",
    isAllListed: query.get("list") === "all",
  };
}

export function formatUrl(state: UrlState): string {
  const query = new URLSearchParams();
  if (state.object !== null) query.set("object", String(state.object));
  if (state.video !== null) query.set("video", String(state.video));
  if (state.time !== null) query.set("t", state.time.toFixed(3).replace(/\.?0+$/, ""));
  const { text: words, models, video, review, minScore, area: chosen } = state.filters;
  if (words.trim() !== "") query.set("q", words);
  for (const one of models) query.append("model", one);
  if (video !== null) query.set("in", String(video));
  if (review !== "all") query.set("review", review);
  if (minScore > 0) query.set("min", String(minScore));
  if (state.order !== "queue") query.set("order", state.order);
  if (state.isAllListed) query.set("list", "all");
  // Commas need no escape, and an area has many.
  const area = chosen === null ? "" : `${query.size > 0 ? "&" : ""}area=${formatArea(chosen)}`;
  const text = query.toString() + area;
  return text === "" ? "" : `?${text}`;
}
