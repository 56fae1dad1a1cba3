// Shows exact frames of a video. Whatever the browser presents is copied to a canvas together with the number of its
// frame, looked up by its time stamp in the table of presentation times; everything drawn over it uses that number, so
// that box and picture cannot part. The time stamp is that of the copied picture: the browser may have gone on to
// another one since it announced a frame. Of a video that the browser cannot play, the server makes a copy; until it is
// there, the video is shown frame by frame as images.
import { batch, effect, signal } from "@preact/signals";

import { frameUrl, videoCopyUrl, videoFileUrl } from "./api/client";
import { askForCopy } from "./jobs";
import type { FrameTable } from "./logic/frame_table";
import * as notices from "./notices";
import * as state from "./state";

/** Why the browser does not play the video; null: it does. */
export const unplayable = signal<string | null>(null);
/** Changes when another picture lies on the frame canvas. */
export const pictureVersion = signal(0);
export const playbackRate = signal(1);

/** The picture of state.shownFrame, in the video's pixels. */
export const frameCanvas = document.createElement("canvas");

/** Of one time: the browser rounds time stamps to microseconds. */
const SAME_TIME_S = 1e-3;

/** The picture that the element shows now; null: the browser cannot hold it (it lacks WebCodecs, or nothing is decoded). */
function holdPicture(element: HTMLVideoElement): VideoFrame | null {
  try {
    return new VideoFrame(element);
  } catch {
    return null;
  }
}

class Player {
  private element: HTMLVideoElement | null = null;
  private video: number | null = null;
  private isCopy = false;
  /** Videos whose file this browser cannot play. */
  private readonly unplayableFiles = new Set<number>();
  /** Whether this browser gives a held picture its own time stamp: some give it another time, or none. */
  private holdsTimes = false;
  /** Time stamp of the first frame; null until the browser has presented it. */
  private origin: number | null = null;
  private wanted: number | null = null;
  private isLoadingImage = false;

  attach(element: HTMLVideoElement) {
    this.element = element;
    // Before anything is loaded: a callback that is asked for later misses the first frame.
    element.requestVideoFrameCallback(this.onFrame);
    element.addEventListener("seeked", () => this.seekOn());
    element.addEventListener("play", () => (state.isPlaying.value = true));
    element.addEventListener("pause", () => (state.isPlaying.value = false));
    element.addEventListener("error", () => this.giveUp());
    // A browser may play the sound of a video whose pictures it cannot decode.
    element.addEventListener("loadedmetadata", () => element.videoWidth === 0 && this.giveUp());
    effect(() => this.open(state.videoId.value));
    effect(() => {
      const hasCopy = state.video.value?.has_copy === true;
      if (hasCopy && unplayable.peek() !== null && state.video.peek()?.id === this.video) this.playCopy();
    });
    effect(() => {
      const request = state.seekRequest.value;
      const table = state.frameTable.value;
      if (request && table.state === "ready" && request.video === state.videoId.value) {
        this.wanted = table.value.nearest(request.time);
        this.seekOn();
      }
    });
    effect(() => {
      element.playbackRate = playbackRate.value;
    });
  }

  private open(video: number | null) {
    if (video === this.video || !this.element) return;
    this.video = video;
    this.origin = null;
    this.wanted = null;
    unplayable.value = null;
    state.isPlaying.value = false;
    if (video === null) return;
    this.isCopy = this.unplayableFiles.has(video) && this.hasCopy();
    this.element.src = this.isCopy ? videoCopyUrl(video) : videoFileUrl(video);
    this.element.load();
  }

  private hasCopy(): boolean {
    return state.videos.peek().find((one) => one.id === this.video)?.has_copy === true;
  }

  /** Goes on with the copy at the frame that is shown. */
  private playCopy() {
    if (this.video === null || !this.element || this.isCopy) return;
    this.isCopy = true;
    this.wanted ??= state.shownFrame.peek();
    this.origin = null;
    unplayable.value = null;
    state.isPlaying.value = false;
    this.element.src = videoCopyUrl(this.video);
    this.element.load();
  }

  private table(): FrameTable | null {
    const table = state.frameTable.peek();
    return table.state === "ready" ? table.value : null;
  }

  private readonly onFrame = (_: number, metadata: VideoFrameCallbackMetadata) => {
    const element = this.element;
    if (!element) return;
    element.requestVideoFrameCallback(this.onFrame);
    const picture = holdPicture(element);
    try {
      this.showPresented(element, picture, metadata);
    } finally {
      picture?.close();
    }
  };

  private showPresented(element: HTMLVideoElement, picture: VideoFrame | null, metadata: VideoFrameCallbackMetadata) {
    const held = picture === null ? NaN : picture.timestamp / 1e6;
    this.holdsTimes ||= metadata.mediaTime > SAME_TIME_S && Math.abs(held - metadata.mediaTime) < SAME_TIME_S / 2;
    const time = picture && this.holdsTimes ? held : metadata.mediaTime;
    // The first frame that a video presents is its first one.
    const isFirst = this.origin === null;
    this.origin ??= time;
    const table = this.table();
    // If the table arrives later, the frame is asked for again then.
    if (!table) return;
    const width = picture?.displayWidth ?? metadata.width;
    const height = picture?.displayHeight ?? metadata.height;
    this.show(picture ?? element, table.nearest(time - this.origin), width, height);
    if (isFirst) this.seekOn();
  }

  private show(picture: CanvasImageSource, frame: number, width: number, height: number) {
    if (frameCanvas.width !== width) frameCanvas.width = width;
    if (frameCanvas.height !== height) frameCanvas.height = height;
    frameCanvas.getContext("2d")?.drawImage(picture, 0, 0, width, height);
    batch(() => {
      state.shownFrame.value = frame;
      pictureVersion.value++;
    });
  }

  /** Goes to the wanted frame once the browser is ready for it: of many requests the last one counts. */
  private seekOn() {
    const table = this.table();
    if (!table || this.wanted === null || !this.element) return;
    if (unplayable.value !== null) return void this.loadImage();
    if (this.origin === null || this.element.seeking) return;
    const frame = this.wanted;
    this.wanted = null;
    const time = this.origin + table.seekTime(frame);
    if (state.shownFrame.peek() === frame && this.element.paused) return;
    this.element.currentTime = time;
  }

  private giveUp() {
    const video = this.video;
    const error = this.element?.error;
    const hasNoPictures = !error && this.element?.readyState !== 0 && this.element?.videoWidth === 0;
    if (video === null || !(error || hasNoPictures)) return;
    // A copy does not help where the connection failed.
    const isOfFormat = hasNoPictures || error?.code === MediaError.MEDIA_ERR_SRC_NOT_SUPPORTED || error?.code === MediaError.MEDIA_ERR_DECODE;
    if (isOfFormat) this.unplayableFiles.add(video);
    if (isOfFormat && !this.isCopy && this.hasCopy()) return this.playCopy();
    const reason = isOfFormat ? "This browser cannot play the format of this video" : "The video could not be loaded";
    unplayable.value = `${reason}: it is shown frame by frame, without sound.`;
    state.isPlaying.value = false;
    // Of a file that is not there, the page says so already.
    if (isOfFormat && !this.isCopy && !state.video.peek()?.missing) {
      void askForCopy(video).then((isComing) => {
        const isWaiting = unplayable.value !== null && this.video === video;
        if (isComing && isWaiting) unplayable.value = `${reason}: it is shown frame by frame until a copy is made that it can play.`;
      });
    }
    this.wanted ??= state.shownFrame.peek() ?? 0;
    this.seekOn();
  }

  private async loadImage() {
    const video = this.video;
    if (this.isLoadingImage || video === null) return;
    this.isLoadingImage = true;
    try {
      while (this.wanted !== null && video === this.video) {
        const frame = this.wanted;
        this.wanted = null;
        const image = new Image();
        image.src = frameUrl(video, frame);
        await image.decode();
        if (video === this.video) this.show(image, frame, image.naturalWidth, image.naturalHeight);
      }
    } catch {
      unplayable.value = "This video can be neither played nor read; its file may have moved.";
    } finally {
      this.isLoadingImage = false;
    }
    if (video !== this.video) this.seekOn();
  }

  togglePlay() {
    const element = this.element;
    if (!element || this.video === null) return;
    if (unplayable.value !== null) {
      state.isPlaying.value = !state.isPlaying.value;
      if (state.isPlaying.value) void this.playImages();
      return;
    }
    if (element.paused) void element.play().catch((error: unknown) => notices.notify(String(error), "error"));
    else element.pause();
  }

  private async playImages() {
    const video = this.video;
    while (state.isPlaying.value && video === this.video) {
      const table = this.table();
      const frame = state.shownFrame.peek();
      if (!table || frame === null || frame + 1 >= table.count) break;
      const start = performance.now();
      this.wanted = frame + 1;
      await this.loadImage();
      const due = ((table.timeOf(frame + 1) - table.timeOf(frame)) * 1000) / playbackRate.value;
      await new Promise((resolve) => setTimeout(resolve, Math.max(0, due - (performance.now() - start))));
    }
    state.isPlaying.value = false;
  }
}

export const player = new Player();
