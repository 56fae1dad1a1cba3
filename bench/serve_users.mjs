// node bench/serve_users.mjs URL PASSWORD [USERS] [SECONDS] [SOCKETS]: measures `victorious serve` with many users at
// once, as JSON. Each user is logged in (accounts user-1, user-2, …, all with PASSWORD), listens to events, and reads and
// reviews with pauses of 0.2 to 1 s, as in bench/page_scale.mjs. In the second half, another client opens SOCKETS
// connections and sends nothing. URL is https://127.0.0.1:PORT; its certificate is not checked. bench/serve_users.py makes
// the index and the accounts, and serves it.
import https from "node:https";
import tls from "node:tls";

const [base, password, users = "50", seconds = "30", sockets = "1000"] = process.argv.slice(2);
const { hostname, port } = new URL(base);

/** The value that a fraction of the sorted values does not exceed. */
const quantile = (values, part) => [...values].sort((a, b) => a - b)[Math.min(Math.floor(part * values.length), values.length - 1)];
const summary = (values) => ({
  n: values.length, median: +quantile(values, 0.5).toFixed(1), p99: +quantile(values, 0.99).toFixed(1), max: +Math.max(...values).toFixed(1),
});
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

let seed = 7;
const random = () => (seed = (seed * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;
const below = (count) => Math.floor(random() * count);

class User {
  constructor(number) {
    this.name = `user-${number}`;
    this.agent = new https.Agent({ keepAlive: true, maxSockets: 4, rejectUnauthorized: false });
    this.cookie = "";
  }

  ask(method, path, body) {
    const headers = { Cookie: this.cookie, ...(body === undefined ? {} : { "Content-Type": "application/json" }) };
    return new Promise((resolve, reject) => {
      const request = https.request({ hostname, port, method, path: `/api/v1${path}`, headers, agent: this.agent, timeout: 60_000 }, (answer) => {
        const parts = [];
        answer.on("data", (part) => parts.push(part));
        answer.on("end", () => resolve({ status: answer.statusCode, headers: answer.headers, body: Buffer.concat(parts).toString() }));
        answer.on("error", reject);
      });
      request.on("timeout", () => request.destroy(new Error("no answer in 60 s")));
      request.on("error", reject);
      request.end(body === undefined ? undefined : JSON.stringify(body));
    });
  }

  async logIn() {
    const answer = await this.ask("POST", "/session", { name: this.name, password });
    if (answer.status !== 200) throw new Error(`log-in of ${this.name}: ${answer.status} ${answer.body}`);
    this.cookie = answer.headers["set-cookie"][0].split(";")[0];
  }

  /** Follows the server's events until it is ended. */
  listen() {
    const request = https.get({ hostname, port, path: "/api/v1/events", headers: { Cookie: this.cookie }, rejectUnauthorized: false });
    request.on("response", (answer) => answer.on("data", () => this.events++));
    request.on("error", () => undefined); // of its end
    this.events = 0;
    this.stream = request;
  }
}

function actions(ids) {
  const some = () => ids[below(ids.length)];
  return [
    ["list", () => ["GET", `/objects?sort=queue&limit=100&offset=${100 * below(490)}`]],
    ["object", () => ["GET", `/objects/${some()}`]],
    ["object", () => ["GET", `/objects/${some()}`]],
    ["sightings", () => ["GET", `/videos/${1 + below(1000)}/sightings?from=${below(500)}&to=600&limit=2000`]],
    ["counts", () => ["GET", `/objects/counts?min_score=${random().toFixed(2)}`]],
    ["review", () => ["PUT", `/objects/${some()}/review`, { verdict: random() < 0.7 ? "accepted" : "rejected", note: "" }]],
    ["review", () => ["PUT", `/objects/${some()}/review`, { verdict: random() < 0.7 ? "accepted" : "rejected", note: "" }]],
  ];
}

async function work(user, choices, until, times, failures) {
  await pause(1000 * random());
  while (performance.now() < until) {
    const [name, make] = choices[below(choices.length)];
    const begin = performance.now();
    try {
      const { status, body } = await user.ask(...make());
      if (status !== 200) failures.push(`${name}: ${status} ${body.slice(0, 200)}`);
    } catch (error) {
      failures.push(`${name}: ${error.message}`);
    }
    (times[name] ??= []).push(performance.now() - begin);
    await pause(200 + 800 * random());
  }
}

const result = (times, failures) => ({
  ...Object.fromEntries(Object.entries(times).map(([name, all]) => [name, summary(all)])),
  all: summary(Object.values(times).flat()),
  errors: failures.length,
  ...(failures.length > 0 ? { first_errors: failures.slice(0, 3) } : {}),
});

/** Connections of another address that finish the handshake and then say nothing. */
async function flood(count) {
  const state = { open: 0, closed: 0, sockets: [] };
  for (let i = 0; i < count; i++) {
    const socket = tls.connect({ host: hostname, port: Number(port), localAddress: "127.0.0.2", rejectUnauthorized: false });
    socket.on("secureConnect", () => state.open++);
    socket.on("error", () => undefined);
    socket.on("close", () => state.closed++);
    state.sockets.push(socket);
    if (i % 50 === 49) await pause(20);
  }
  return state;
}

const everybody = Array.from({ length: Number(users) }, (_, i) => new User(i + 1));
const logIns = [];
for (const user of everybody) {
  const begin = performance.now();
  await user.logIn();
  logIns.push(performance.now() - begin);
  user.listen();
}
const { objects } = JSON.parse((await everybody[0].ask("GET", "/objects?limit=1000")).body);
const choices = actions(objects.map((one) => one.id));
const half = 500 * Number(seconds);

const run = async () => {
  const [times, failures] = [{}, []];
  const until = performance.now() + half;
  await Promise.all(everybody.map((user) => work(user, choices, until, times, failures)));
  return result(times, failures);
};
const alone = await run();
const [silent, beside] = await Promise.all([flood(Number(sockets)), run()]);
const sockets_left = silent.sockets.filter((one) => !one.destroyed).length;
for (const socket of silent.sockets) socket.destroy();
for (const user of everybody) user.stream.destroy();
console.log(JSON.stringify({
  users: everybody.length, log_in: summary(logIns), alone, beside_silent_sockets: beside,
  silent_sockets: { asked: Number(sockets), accepted: silent.open, left: sockets_left },
  streams_of_events: everybody.filter((user) => user.events > 0).length,
}, null, 1));
process.exit(0);
