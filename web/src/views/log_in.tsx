// The form to log in, above everything.
import { useEffect, useRef, useState } from "preact/hooks";

import { messageOf } from "../logic/errors";
import { plural } from "../logic/format";
import { waiting } from "../reviews";
import { logIn, needsLogIn } from "../session";

export function LogIn() {
  const dialog = useRef<HTMLDialogElement>(null);
  const isOpen = needsLogIn.value;
  const [name, setName] = useState("");
  const [password, setPassword] = useState("");
  const [problem, setProblem] = useState("");
  const [isSending, setSending] = useState(false);
  useEffect(() => {
    if (isOpen) dialog.current?.showModal();
    else dialog.current?.close();
  }, [isOpen]);
  const send = async (event: Event) => {
    event.preventDefault();
    setSending(true);
    setProblem("");
    try {
      await logIn(name, password);
    } catch (error) {
      setProblem(messageOf(error));
    }
    setPassword("");
    setSending(false);
  };
  return (
    <dialog
      class="log-in"
      ref={dialog}
      aria-labelledby="log-in-title"
      onCancel={(event) => event.preventDefault()}
      onClose={() => needsLogIn.value && dialog.current?.showModal()}
    >
      <form onSubmit={(event) => void send(event)}>
        <h2 id="log-in-title">Log in to VICTORIOUS</h2>
        <label for="log-in-name">Name</label>
        <input
          id="log-in-name"
          class="field"
          autocomplete="username"
          autocapitalize="none"
          spellcheck={false}
          required
          autofocus
          maxLength={64}
          value={name}
          onInput={(event) => setName(event.currentTarget.value)}
        />
        <label for="log-in-password">Password</label>
        <input
          id="log-in-password"
          class="field"
          type="password"
          autocomplete="current-password"
          required
          value={password}
          onInput={(event) => setPassword(event.currentTarget.value)}
        />
        {[...waiting.value].map(([reviewer, count]) => (
          <p key={reviewer}>
            {plural(count, "review")} of {reviewer || "a reviewer without a name"}: kept, and stored after a log-in with that name.
          </p>
        ))}
        <p class="problem" role="alert">
          {problem}
        </p>
        <button class="button primary" disabled={isSending}>
          {isSending ? "Logging in" : "Log in"}
        </button>
      </form>
    </dialog>
  );
}
