// The presentation times of a video's frames. Frames and times are looked up here, never computed from a frame rate.

export class FrameTable {
  constructor(
    /** s, by frame, strictly increasing, the first is 0 */
    readonly times: readonly number[],
  ) {}

  get count(): number {
    return this.times.length;
  }

  /** Time of the last frame, s. */
  get end(): number {
    return this.times[this.times.length - 1] ?? 0;
  }

  /** The frame that is shown at a time: the last one that starts at or before it. */
  frameAt(time: number): number {
    let low = 0;
    let high = this.times.length - 1;
    // Times pass through the container's and the browser's roundings of a microsecond.
    const latest = time + 1e-4;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if ((this.times[middle] ?? Infinity) <= latest) low = middle;
      else high = middle - 1;
    }
    return Math.max(low, 0);
  }

  /** The frame whose time is nearest. */
  nearest(time: number): number {
    const frame = this.frameAt(time);
    const here = this.times[frame];
    const next = this.times[frame + 1];
    return here !== undefined && next !== undefined && next - time < time - here ? frame + 1 : frame;
  }

  timeOf(frame: number): number {
    return this.times[this.clamp(frame)] ?? 0;
  }

  /**
   * A time at which a player surely shows the frame: shortly after its beginning. Later is not sure: with B-frames, a
   * container can say that a frame before a gap ends long before the next one begins.
   */
  seekTime(frame: number): number {
    const here = this.timeOf(frame);
    const next = this.times[this.clamp(frame) + 1] ?? Infinity;
    return here + Math.min(1e-3, (next - here) / 2);
  }

  clamp(frame: number): number {
    return Math.min(Math.max(Math.round(frame), 0), Math.max(this.times.length - 1, 0));
  }
}
