// What is shown of an error.

export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** What the page calls a field of the API. */
const FIELDS: Readonly<Record<string, string>> = {
  url: "The address",
  name: "The name",
  length_m: "The length",
  type: "What it is",
  note: "The note",
  reviewer: "Your name",
};

/** A path of the server's files; not a part of an address or of a word. */
const FOLDERS = /(?<![\w:/.])\/(?:[^\s:;,'"`/]+\/)+(?=[^\s/])/g;
const IS_COMMAND = /`|(?:^|\s)--[a-z]/;

/** A message of the server without folders of its machine and without what to type at a command line. */
export function forReaders(message: string): string {
  const short = message.replaceAll(FOLDERS, "");
  if (!IS_COMMAND.test(short)) return short;
  const clauses = short.split(/(?<=[:;.])\s+/);
  const kept = clauses.slice(0, clauses.findIndex((one) => IS_COMMAND.test(one))).join(" ");
  return kept === "" ? short : `${kept.replace(/[:;,.]+$/, "")}.`;
}

/** The server's message, with the page's word for the field that it is about. */
export function withoutField({ message, field }: { message: string; field: string | null }): string {
  const name = field === null ? undefined : FIELDS[field];
  return forReaders(name !== undefined && message.startsWith(`${field}: `) ? `${name} ${message.slice(`${field}: `.length)}` : message);
}
