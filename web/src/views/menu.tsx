// A button that opens a menu: nothing happens before an item is chosen, by mouse or by keys.
import { useEffect, useId, useRef, useState } from "preact/hooks";

export interface MenuItem {
  label: string;
  choose: () => void;
}

/** @param title  what the menu is for, also for who cannot see it */
export function Menu({ label, title, items }: { label: string; title: string; items: readonly MenuItem[] }) {
  const root = useRef<HTMLDivElement>(null);
  const button = useRef<HTMLButtonElement>(null);
  const [isOpen, setIsOpen] = useState(false);
  const id = useId();
  const entries = () => [...(root.current?.querySelectorAll<HTMLElement>("[role=menuitem]") ?? [])];
  useEffect(() => {
    if (!isOpen) return;
    entries()[0]?.focus();
    const leave = (event: PointerEvent) => {
      if (!root.current?.contains(event.target as Node)) setIsOpen(false);
    };
    window.addEventListener("pointerdown", leave);
    return () => window.removeEventListener("pointerdown", leave);
  }, [isOpen]);
  const close = () => {
    setIsOpen(false);
    button.current?.focus();
  };
  const keys = (event: KeyboardEvent) => {
    const all = entries();
    const at = all.indexOf(document.activeElement as HTMLElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1 + all.length, Home: 0, End: all.length - 1 }[event.key];
    if (event.key === "Escape" && isOpen) close();
    else if (event.key === "ArrowDown" && !isOpen) setIsOpen(true);
    else if (to !== undefined && isOpen) all[to % all.length]?.focus();
    else if (event.key === "Tab") return setIsOpen(false);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <div class="menu" ref={root} onKeyDown={keys}>
      <button class="chip" ref={button} title={title} aria-haspopup="menu" aria-expanded={isOpen} aria-controls={id} onClick={() => setIsOpen(!isOpen)}>
        {label} <span aria-hidden="true">▾</span>
      </button>
      {isOpen && (
        <div id={id} role="menu" aria-label={title}>
          {items.map((one) => (
            <button
              key={one.label}
              role="menuitem"
              tabIndex={-1}
              onClick={() => {
                close();
                one.choose();
              }}
            >
              {one.label}
            </button>
          ))}
        </div>
      )}
    </div>
  );
}
