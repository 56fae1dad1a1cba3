// A picture that the server makes. Where there is none, it says so; it is asked for again once the server is back.
import { useEffect, useState } from "preact/hooks";

import * as state from "../state";

export function Picture({ src, alt, width, height }: { src: string; alt: string; width?: number; height?: number }) {
  const [failed, setFailed] = useState<string | null>(null);
  const isConnected = state.isConnected.value;
  useEffect(() => {
    if (isConnected) setFailed(null);
  }, [isConnected]);
  if (failed === src) return <span class="none">{alt === "" ? "" : "no picture"}</span>;
  const size = { ...(width && { width }), ...(height && { height }) };
  return <img src={src} alt={alt} loading="lazy" decoding="async" {...size} onError={() => setFailed(src)} />;
}
