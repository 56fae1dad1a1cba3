import { render } from "preact";

import { App } from "./views/app";
import { startJobs } from "./jobs";
import { startSession } from "./session";
import { startWorkers } from "./workers";
import { load } from "./load";

import "./styles/tokens.css";
import "./styles/app.css";

const root = document.getElementById("app");
if (root) render(<App />, root);
void startSession().then(load).then(startJobs).then(startWorkers);
