// Events of the server, one stream a browser: the tab that holds a lock listens and tells the others, so that many open
// tabs do not use up the browser's connections to the server. When it closes, the lock goes to another tab.
const ROOT = "/api/v1/events";
const RETRY_MS = 5000;
const NAMES = ["index", "jobs"] as const;

export type EventName = (typeof NAMES)[number];
type Handler = (data: unknown) => void;

const handlers = new Map<EventName, Handler[]>();
const channel = new BroadcastChannel("victorious-events");
/** The latest event of each name, sent to a tab that opens later. */
const latest = new Map<EventName, unknown>();
let isLeader = false;

interface Message {
  name: EventName | "hello";
  data?: unknown;
}

function handle(name: EventName, data: unknown) {
  for (const handler of handlers.get(name) ?? []) handler(data);
}

channel.onmessage = ({ data: message }: MessageEvent<Message>) => {
  if (message.name !== "hello") return handle(message.name, message.data);
  if (isLeader) for (const [name, data] of latest) channel.postMessage({ name, data });
};

function listen() {
  isLeader = true;
  const source = new EventSource(ROOT);
  // EventSource connects again by itself, but not after a refusal: the session may have ended.
  source.onerror = () => {
    if (source.readyState === EventSource.CLOSED) setTimeout(listen, RETRY_MS);
  };
  for (const name of NAMES) {
    source.addEventListener(name, (event: MessageEvent<string>) => {
      const data: unknown = JSON.parse(event.data);
      latest.set(name, data);
      channel.postMessage({ name, data });
      handle(name, data);
    });
  }
}

export function onEvent(name: EventName, handler: Handler) {
  handlers.set(name, [...(handlers.get(name) ?? []), handler]);
}

/** Begins to listen. EventSource connects again by itself when the server was away. */
export function startEvents() {
  // Held as long as the tab is open.
  void navigator.locks.request("victorious-events", () => {
    listen();
    return new Promise(() => undefined);
  });
  channel.postMessage({ name: "hello" });
}
