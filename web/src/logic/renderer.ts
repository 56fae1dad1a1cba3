// What draws WebGL, by the name that a browser gives.

/** Whether it is the processor, without a GPU. */
export function isSoftware(renderer: string): boolean {
  return /swiftshader|llvmpipe|softpipe|software|microsoft basic render/i.test(renderer);
}
