// A long list of which only pages are loaded: ids by position.

export class PagedList {
  private readonly pages = new Map<number, readonly number[]>();
  private readonly positions = new Map<number, number>();

  constructor(
    /** Of all pages. */
    readonly total: number,
    readonly pageSize: number,
  ) {}

  /** Adds the page that begins at a position, a multiple of the size of a page. */
  add(offset: number, ids: readonly number[]) {
    this.pages.set(offset / this.pageSize, ids);
    ids.forEach((id, i) => this.positions.set(id, offset + i));
  }

  /** The id at a position; undefined if its page is not loaded. */
  at(position: number): number | undefined {
    return this.pages.get(Math.floor(position / this.pageSize))?.[position % this.pageSize];
  }

  positionOf(id: number): number | undefined {
    return this.positions.get(id);
  }

  isLoaded(page: number): boolean {
    return this.pages.has(page);
  }

  /** The pages that hold positions from `first` to `last`, without those that are loaded. */
  missingPages(first: number, last: number): number[] {
    const missing: number[] = [];
    const end = Math.min(last, this.total - 1);
    for (let page = Math.floor(Math.max(first, 0) / this.pageSize); page * this.pageSize <= end; page++) {
      if (!this.pages.has(page)) missing.push(page);
    }
    return missing;
  }

  /**
   * The nearest id before (-1) or after (1) a position that passes a test. "end": the list ends first; "unknown": a page
   * that is not loaded comes first.
   */
  find(from: number, by: 1 | -1, test: (id: number) => boolean): number | "end" | "unknown" {
    for (let position = from + by; ; position += by) {
      if (position < 0 || position >= this.total) return "end";
      const id = this.at(position);
      if (id === undefined) return "unknown";
      if (test(id)) return id;
    }
  }
}
