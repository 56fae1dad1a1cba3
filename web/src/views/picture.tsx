// A picture that the server makes. Where there is none, it says so; it is asked for again once the server is back, and some
// times if the server was busy.
import { useEffect, useRef, useState } from "preact/hooks";

import * as state from "../state";

const RETRY_MS = 3000;
const MAX_TRIES = 3;

export function Picture({ src, alt, width, height }: { src: string; alt: string; width?: number; height?: number }) {
  const [failed, setFailed] = useState<string | null>(null);
  const tries = useRef(0);
  const isConnected = state.isConnected.value;
  useEffect(() => {
    tries.current = 0;
    if (isConnected) setFailed(null);
  }, [isConnected, src]);
  useEffect(() => {
    if (failed === null || tries.current >= MAX_TRIES) return undefined;
    const timer = setTimeout(() => setFailed(null), RETRY_MS * tries.current);
    return () => clearTimeout(timer);
  }, [failed]);
  if (failed === src) return <span class="none">{alt === "" ? "" : "no picture"}</span>;
  const size = { ...(width && { width }), ...(height && { height }) };
  const fail = () => {
    tries.current += 1;
    setFailed(src);
  };
  return <img src={src} alt={alt} loading="lazy" decoding="async" {...size} onError={fail} />;
}
