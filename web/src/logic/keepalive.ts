// Requests that a browser finishes after its page is left: only few and small ones, of all that are on their way
// together.

/** Bytes; browsers take 64 KiB of bodies in all, headers aside. */
const MAX_BYTES = 32 * 1024;
/** Browsers take some 20 such requests of a page. */
const MAX_REQUESTS = 8;

/** What is left of what the browser takes. A request beyond it would fail at once. */
export class KeepaliveBudget {
  private bytes = 0;
  private requests = 0;

  /** Whether a body may be sent so; `give` returns what it took. */
  take(body: number): boolean {
    if (this.requests >= MAX_REQUESTS || this.bytes + body > MAX_BYTES) return false;
    this.bytes += body;
    this.requests++;
    return true;
  }

  give(body: number) {
    this.bytes -= body;
    this.requests--;
  }
}
