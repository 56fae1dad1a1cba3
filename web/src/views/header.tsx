import { givenName } from "../me";
import { counts, ownCount } from "../objects";
import { account, logOut } from "../session";
import * as notices from "../notices";
import * as state from "../state";
import { baseName } from "../logic/format";
import { Icon } from "./icons";
import { JobsButton } from "./jobs";
import { WorkersButton } from "./workers";

const NEXT_THEME = { system: "light", light: "dark", dark: "system" } as const;

function Progress() {
  const known = counts.value;
  if (!known || known.objects === 0) return null;
  const { accepted, rejected, objects: all } = known;
  const part = (count: number) => ({ width: `${(100 * count) / all}%` });
  const own = ownCount.value;
  return (
    <div class="progress" title={`By the team: ${accepted} accepted, ${rejected} rejected`}>
      <span class="bar" aria-hidden="true">
        <span class="accepted" style={part(accepted)} />
        <span class="rejected" style={part(rejected)} />
      </span>
      <span>
        {(accepted + rejected).toLocaleString("en")} of {all.toLocaleString("en")} reviewed
        {own !== null && own !== accepted + rejected && <span class="own">, {own.toLocaleString("en")} by you</span>}
      </span>
    </div>
  );
}

/** The account, or the name that a reviewer gives where there are none. */
function Reviewer() {
  const user = account.value;
  if (user) {
    const leave = () => logOut().catch((error: unknown) => notices.notify(String(error), "error"));
    return (
      <div class="user">
        <span title={`Logged in as ${user.role}`}>
          {user.name} <span class="muted">{user.role}</span>
        </span>
        <button class="button" onClick={() => void leave()}>
          Log out
        </button>
      </div>
    );
  }
  return (
    <>
      <label class="hidden" for="reviewer">
        Your name, kept with your reviews
      </label>
      <input
        id="reviewer"
        class="field reviewer"
        autocomplete="name"
        maxLength={80}
        placeholder="Your name"
        title="Your name, kept with your reviews"
        value={givenName.value}
        onInput={(event) => (givenName.value = event.currentTarget.value)}
      />
    </>
  );
}

export function Header() {
  const project = state.project.value;
  const theme = state.theme.value;
  return (
    <header class="head">
      <h1 class="brand">
        <svg viewBox="0 0 16 16" aria-hidden="true">
          <path d="M1 5V1h4M11 1h4v4M15 11v4h-4M5 15H1v-4" fill="none" stroke="var(--accent)" stroke-width="2" />
          <circle cx="8" cy="8" r="2.5" fill="#e69f00" />
        </svg>
        VICTORIOUS
      </h1>
      {project.state === "ready" && (
        <span class="project" title={project.value.name}>
          {baseName(project.value.name)}
        </span>
      )}
      <form class="search" role="search" onSubmit={(event) => event.preventDefault()}>
        <label class="hidden" for="search">
          Search
        </label>
        <input
          id="search"
          class="field"
          type="search"
          autocomplete="off"
          placeholder='Name, note, or "near 52.52,13.40 200 m"'
          title="Words of names and notes; a position as the page copies it (degrees, MGRS, UTM), with a radius"
          value={state.filters.value.text}
          onInput={(event) => state.setFilters({ text: event.currentTarget.value })}
        />
      </form>
      <Progress />
      <Reviewer />
      <WorkersButton />
      <JobsButton />
      <div class="tools">
        <button
          class="button icon plain"
          title={`Colours: ${theme}`}
          aria-label={`Colours: ${theme}. Change`}
          onClick={() => (state.theme.value = NEXT_THEME[theme])}
        >
          <Icon name={theme === "system" ? "system" : theme === "dark" ? "moon" : "sun"} />
        </button>
        <button class="button icon plain" title="Keys (?)" aria-label="Keys" onClick={() => (state.isHelpOpen.value = true)}>
          <Icon name="help" />
        </button>
      </div>
    </header>
  );
}
