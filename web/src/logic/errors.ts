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

/** The server's message, with the page's word for the field that it is about. */
export function withoutField({ message, field }: { message: string; field: string | null }): string {
  const name = field === null ? undefined : FIELDS[field];
  return name !== undefined && message.startsWith(`${field}: `) ? `${name} ${message.slice(`${field}: `.length)}` : message;
}
